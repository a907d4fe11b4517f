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

  Ray(const CameraRays& rays, float x, float y, const Vec2f& lens = Vec2f(0.0f)) {
    ImagePoints points;
    points.lens[5] = lens;
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
    Camera camera = camera_of(projection, 1.0);
    camera.shift = {0.3, -0.2};
    const CameraRays rays(camera, 80, 60);
    const Ray ray(rays, 71.5f, 12.25f);
    const Vec3d in_camera = rays.to_camera(Vec3d(ray.origin) + Vec3d(ray.direction) * 7.0);
    const Imath::V2d at = rays.to_image(in_camera);
    EXPECT_NEAR(at.x, 71.5, 1e-4);
    EXPECT_NEAR(at.y, 12.25, 1e-4);
    EXPECT_NEAR(-in_camera.z, 7.0 * (ray.direction ^ Vec3f(rays.forward())), 1e-5);
  }
}

TEST(CameraRays, OfAShiftedImageShowWhatLiesBesideIt) {
  for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    Camera camera = camera_of(projection, 1.0);
    const CameraRays plain(camera, 80, 60);
    camera.shift = {0.25, 0.5};  // to the right and up
    const CameraRays rays(camera, 80, 60);
    const Ray shifted(rays, 30, 40), expected(plain, 30 + 0.25f * 80, 40 - 0.5f * 60);
    EXPECT_LT((shifted.direction - expected.direction).length(), 1e-6f);
    EXPECT_LT((shifted.origin - expected.origin).length(), 1e-6f);
    EXPECT_EQ(rays.forward(), plain.forward());
  }
}

TEST(CameraRays, OfALensMeetAtItsFocus) {
  for (const auto projection : {Camera::Projection::perspective, Camera::Projection::orthographic}) {
    Camera camera = camera_of(projection, 1.0);
    camera.shift = {0.3, -0.2};
    const CameraRays pinhole(camera, 80, 60);
    camera.aperture = 0.5;
    camera.focus = 3;
    const CameraRays rays(camera, 80, 60);
    const Ray central(pinhole, 11, 22);
    const auto at_focus = [&](const Ray& ray) { return ray.origin + ray.direction * (3 / -ray.direction.z); };
    for (const Vec2f& lens : {Vec2f(0, 0), Vec2f(1, 0), Vec2f(-0.6f, 0.8f)}) {
      const Ray ray(rays, 11, 22, lens);
      EXPECT_LT((ray.origin - central.origin - Vec3f(lens.x, lens.y, 0) * 0.25f).length(), 1e-6f);
      EXPECT_LT((at_focus(ray) - at_focus(central)).length(), 1e-5f);
      EXPECT_NEAR(ray.direction.length(), 1, 1e-6);
    }
  }
}

}  // namespace
}  // namespace patchlight
