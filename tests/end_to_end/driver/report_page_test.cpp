#include <fmt/format.h>
#include <gmock/gmock.h>

#include <set>

#include "pipeline/formats/patches/patch_file.h"
#include "pipeline/formats/solution/energy_file.h"
#include "pipeline/image/image_file.h"
#include "tests/end_to_end/program.h"

namespace patchlight::test {
namespace {

std::string decoded(const std::string& base64) {
  std::string bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char c : base64) {
    const auto digit = std::string("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(c);
    if (digit == std::string::npos) break;
    group = group << 6 | unsigned(digit);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += char(group >> bits & 255);
  }
  return bytes;
}

class ReportPage : public ProgramTest {
 protected:
  void report(const std::string& more = "", const std::string& environment = "") {
    small_job(folder_, more);
    report_job(environment);
  }

  /// Writes the report, and moves its embedded images from the page to `pictures_`.
  void report_job(const std::string& environment) {
    const Outcome outcome = run_program(folder_, "patchlight", {"report", "job.yaml"}, environment);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    page_ = read_text(folder_ / "out/report.html");
    pictures_.clear();
    const std::string begin = "src=\"data:image/png;base64,";
    for (std::size_t at = 0; (at = page_.find(begin, at)) != std::string::npos;) {
      const std::size_t end = page_.find('"', at += begin.size());
      pictures_.insert(decoded(page_.substr(at, end - at)));
      page_.erase(at, end - at);
    }
  }

  bool shows(const std::string& png) const { return pictures_.contains(read_text(folder_ / png)); }

  static std::string row(const std::string& name, const std::string& value) {
    return "<td>" + name + "</td><td>" + value + "</td>";
  }

  std::string page_;
  std::set<std::string> pictures_;
};

TEST_F(ReportPage, HasNoExternalResources) {
  report();
  for (const char* reference : {"http:", "https:", "<script", "<link", "@import", "url("})
    EXPECT_THAT(page_, Not(HasSubstr(reference)));
  EXPECT_EQ(page_.find("src=\"\""), std::string::npos);
}

TEST_F(ReportPage, ShowsTheFramesAndTheIrradianceWithItsScale) {
  report();
  EXPECT_EQ(pictures_.size(), 2u);
  EXPECT_TRUE(shows("out/frames/camera.0001.png"));
  EXPECT_TRUE(shows("out/preview/irradiance.camera.png"));
  EXPECT_THAT(page_, HasSubstr("camera, irradiance, sum of the three channels, W/m2"));
}

TEST_F(ReportPage, AgreesWithTheFiles) {
  report();
  const PatchSet scene = read_patches(folder_ / "out/patches.h5");
  const EnergyField energy = read_energy(folder_ / "out/energy.h5", scene);
  EXPECT_THAT(page_, HasSubstr(row("patches", std::to_string(scene.patches.size()))));
  EXPECT_THAT(page_, HasSubstr(row("rays cast by the last solve", std::to_string(energy.rays))));
  EXPECT_THAT(page_, HasSubstr(row("iterations", std::to_string(energy.iterations))));
  EXPECT_THAT(page_, HasSubstr(row("error", fmt::format("{:.2g}%", 100 * energy.estimate->error))));
  EXPECT_THAT(page_, HasSubstr(row("error, bound", fmt::format("{:.2g}%", 100 * energy.estimate->error_bound))));
  EXPECT_THAT(page_, HasSubstr(row("local error, bound", fmt::format("{:.2g}%", 100 * energy.estimate->error_local))));
  EXPECT_THAT(page_, HasSubstr(row("residual", fmt::format("{:.2g}", energy.residual))));
  EXPECT_THAT(page_, HasSubstr(row("balance", fmt::format("{:.2g}%", 100 * energy.estimate->balance))));
  EXPECT_THAT(page_, HasSubstr(row("reciprocity", fmt::format("{:.2g}%", 100 * energy.estimate->reciprocity))));
  EXPECT_THAT(page_, HasSubstr(fmt::format("residual {:.3g} after {} iterations", energy.residual, energy.iterations)));
  for (const auto& [stage, made] : {std::pair("import", scene.made), {"solve", energy.made}}) {
    EXPECT_GT(made.wall_seconds, 0) << stage;
    EXPECT_GT(made.peak_bytes, 1 << 20) << stage;
    EXPECT_THAT(page_, HasSubstr(row(stage, fmt::format("{:.2f}</td><td>{:.2f}</td><td>{:.1f}", made.wall_seconds,
                                                        made.cpu_seconds, double(made.peak_bytes) / (1 << 20)))));
  }
  Image frame = read_exr(folder_ / "out/frames/camera.0001.exr");
  EXPECT_THAT(page_,
              HasSubstr(row("trace", fmt::format("{:.2f}", std::stod(frame.metadata["patchlight:wall_seconds"])))));
  EXPECT_GT(std::stod(frame.metadata["patchlight:peak_bytes"]), 1 << 20);
  EXPECT_THAT(page_, HasSubstr("camera.0001, 32 x 32"));
}

TEST_F(ReportPage, DrawsTheResidualOfEveryIteration) {
  report();
  const EnergyField energy = read_energy(folder_ / "out/energy.h5");
  ASSERT_EQ(energy.convergence.size(), 1u);
  EXPECT_EQ(energy.convergence[0].group, "lights.ceiling");
  ASSERT_EQ(energy.convergence[0].residuals.size(), std::size_t(energy.iterations) + 1);
  EXPECT_EQ(energy.convergence[0].residuals.back(), energy.residual);
  const std::size_t begin = page_.find("points='") + 8, end = page_.find('\'', begin);
  const std::string points = page_.substr(begin, end - begin);
  EXPECT_EQ(std::count(points.begin(), points.end(), ','), energy.iterations + 1);
  EXPECT_THAT(page_, HasSubstr("lights.ceiling</text>"));
  EXPECT_THAT(page_, HasSubstr("solve.tolerance</text>"));
}

TEST_F(ReportPage, KeepsTheWarningsOfEarlierStages) {
  report("materials: {'<none>': {reflectance: [0, 0, 0]}}\n");
  const std::string warning = "materials.&lt;none&gt; in the job matches no material of the scene";
  EXPECT_THAT(page_, HasSubstr(warning));
  report("materials: {'<none>': {reflectance: [0, 0, 0]}}\nlights: {lights.ceiling: {scale: 2}}\n");
  EXPECT_THAT(page_, HasSubstr(warning)) << "the import did not run again";
  report();
  EXPECT_THAT(page_, Not(HasSubstr(warning)));
}

TEST_F(ReportPage, IsWrittenWithoutOpenGl) {
  report("", "__EGL_VENDOR_LIBRARY_FILENAMES=/none");
  EXPECT_THAT(page_, HasSubstr("the irradiance picture of `camera` could not be drawn (exit code 69)"));
  EXPECT_TRUE(shows("out/frames/camera.0001.png"));
}

TEST_F(ReportPage, ShowsTheBenchWhereOneWasRun) {
  report();
  EXPECT_THAT(page_, Not(HasSubstr("<h3>Bench</h3>")));
  ASSERT_EQ(run_program(folder_, "patchlight",
                        {"bench", "job.yaml", "--set", "bench.sweep=[{solve.rays: [16, 64]}]", "--set",
                         "bench.reference_settings={solve.rays: 256}"})
                .code,
            0);
  report();
  EXPECT_THAT(page_, HasSubstr("<h3>Bench</h3>"));
  EXPECT_TRUE(shows("out/bench/error_against_seconds.png"));
  EXPECT_TRUE(shows("out/bench/comparison.png"));
}

TEST_F(ReportPage, HasASectionForEveryVariant) {
  report("matrix: {trace.exposure: [0, 1], solve.method: [matrix, progressive]}\n");
  for (const char* variant : {"0,matrix", "1,progressive"}) {
    EXPECT_THAT(page_, HasSubstr(std::string("<h2>job.yaml ") + variant + "</h2>"));
    EXPECT_TRUE(shows(std::string("out/") + variant + "/frames/camera.0001.png"));
  }
  EXPECT_THAT(page_, HasSubstr("unshot</text>"));
  EXPECT_THAT(page_, HasSubstr(row("error", "not stated")));
}

TEST_F(ReportPage, ShowsEveryCameraAndLightGroupOfALargerScene) {
  const std::string scene = std::string(PATCHLIGHT_SCENES) + "/blender/gallery.glb";
  if (!std::filesystem::exists(scene)) GTEST_SKIP() << "no scene at " << scene;
  folder_.write("job.yaml", "scene: " + scene +
                                "\noutput: out\nimport: {patch_area: 0.1}\nsolve: {rays: 32, display: false}\n"
                                "trace: {resolution: [96, 54], samples: 1}\n");
  report_job("");
  for (const char* camera : {"cam_hall", "cam_study", "cam_theatre", "cam_walk"}) {
    EXPECT_TRUE(shows(std::string("out/frames/") + camera + ".0001.png")) << camera;
    EXPECT_TRUE(shows(std::string("out/preview/irradiance.") + camera + ".png")) << camera;
  }
  const EnergyField energy = read_energy(folder_ / "out/energy.h5");
  for (const auto& group : energy.groups) EXPECT_THAT(page_, HasSubstr(group.name + "</text>"));
  EXPECT_THAT(page_, HasSubstr(row("iterations", std::to_string(energy.iterations))));
  EXPECT_THAT(page_, HasSubstr(row("error", fmt::format("{:.2g}%", 100 * energy.estimate->error))));
  EXPECT_THAT(page_, HasSubstr("7 triangles without area are skipped"));
}

}  // namespace
}  // namespace patchlight::test
