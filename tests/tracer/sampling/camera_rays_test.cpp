#include "tracer/sampling/camera_rays.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patchlight {
namespace {

Camera camera_of(Camera::Projection projection, double vertical) {
  Camera camera;
  camera.projection = projection;
  camera.vertical = vertical;
  camera.to_world.translate(Vec3d(1, 2, 3));
  return camera;
}

struct Ray {
  Vec3f origin, direction;

  Ray(const CameraRays& rays, float x, float y) {
    ImagePoints points;
    points.x[5] = x;
    points.y[5] = y;
    RayPacket packet;
    rays.generate(points, RayScene(PatchSet{}), packet);
    origin = packet.origin(5);
    direction = packet.direction(5);
  }
};

TEST(CameraRays, KeepTheVerticalAngleForAnyShapeOfImage) {
  for (const int width : {50, 100, 300}) {
    const CameraRays rays(camera_of(Camera::Projection::perspective, 1.0), width, 100);
    const Ray top(rays, float(width) / 2, 0), middle(rays, float(width) / 2, 50);
    EXPECT_NEAR(std::acos(double(top.direction ^ middle.direction)), 0.5, 1e-6);
    EXPECT_LT((middle.direction - Vec3f(0, 0, -1)).length(), 1e-6f);
    EXPECT_EQ(middle.origin, Vec3f(1, 2, 3));
  }
}

TEST(CameraRays, LeftOfTheImageIsLeftOfTheCamera) {
  const CameraRays rays(camera_of(Camera::Projection::perspective, 1.0), 100, 100);
  EXPECT_LT(Ray(rays, 0, 50).direction.x, 0);
  EXPECT_GT(Ray(rays, 50, 0).direction.y, 0);
}

TEST(CameraRays, OfAnOrthographicCameraAreParallel) {
  const CameraRays rays(camera_of(Camera::Projection::orthographic, 2.0), 200, 100);
  EXPECT_EQ(Ray(rays, 0, 0).direction, Vec3f(0, 0, -1));
  EXPECT_EQ(Ray(rays, 0, 0).origin, Vec3f(1 - 4, 2 + 2, 3));
}

TEST(CameraRays, PassThroughTheImagePointThatToImageFinds) {
  for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    const CameraRays rays(camera_of(projection, 1.0), 80, 60);
    const Ray ray(rays, 71.5f, 12.25f);
    const Vec3d in_camera = rays.to_camera(Vec3d(ray.origin) + Vec3d(ray.direction) * 7.0);
    const Imath::V2d at = rays.to_image(in_camera);
    EXPECT_NEAR(at.x, 71.5, 1e-4);
    EXPECT_NEAR(at.y, 12.25, 1e-4);
    EXPECT_NEAR(-in_camera.z, 7.0 * (ray.direction ^ Vec3f(rays.forward())), 1e-5);
  }
}

}  // namespace
}  // namespace patchlight
