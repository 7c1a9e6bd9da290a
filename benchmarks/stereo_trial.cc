#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/gray.h"
#include "colmap_tsar/workspace/map_io.h"
#include "colmap_tsar/workspace/workspace.h"
#include <opencv2/imgproc.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <algorithm>
#include <filesystem>
using namespace tsar;
using Clock = std::chrono::steady_clock;
static int Env(const char* n, int d) { const char* s = getenv(n); return s ? atoi(s) : d; }
static double EnvF(const char* n, double d) { const char* s = getenv(n); return s ? atof(s) : d; }
struct Level { int width, height; std::vector<DeviceImage<float>> gray; };
int main(int argc, char** argv) {
  // stereo_trial WORKSPACE OUT WIDTH DEVICE
  const Workspace ws(argv[1], MapType::kPhotometric);
  const std::filesystem::path out = argv[2];
  const int max_size = atoi(argv[3]);
  auto device = std::string(argv[4]) == "cuda" ? Device::CreateCuda(0) : Device::CreateCpu(0);
  const int num_levels = Env("LEVELS", 3), iters = Env("ITERS", 4), geo_passes = Env("GEO", 2), geo_iters = Env("GEOITERS", 2);
  const size_t n = ws.Model().images.size();
  std::vector<std::vector<Camera>> cam(n);
  std::vector<std::vector<DeviceImage<float>>> gray(n);
  std::vector<PatchMatchOptions> opt(n);
  for (size_t i = 0; i < n; ++i) {
    const auto& im = ws.Model().images[i];
    const double scale = std::min(1.0, double(max_size) / std::max(im.camera.width, im.camera.height));
    int w = std::lround(im.camera.width * scale), h = std::lround(im.camera.height * scale);
    Image<Rgb> color = ws.ReadImage(i, w, h);
    DeviceImage<Rgb> dc(*device, color);
    Image<float> g = ComputeGray(dc.View(), *device).ToHost();
    cv::Mat m(h, w, CV_32F, g.Data());
    for (int l = 0; l < num_levels; ++l) {
      int lw = std::max(1, w >> l), lh = std::max(1, h >> l);
      cv::Mat r;
      cv::resize(m, r, {lw, lh}, 0, 0, cv::INTER_AREA);
      Image<float> gi(lw, lh);
      std::copy(r.ptr<float>(), r.ptr<float>() + size_t(lw) * lh, gi.Data());
      gray[i].emplace_back(*device, gi);
      cam[i].push_back(im.camera.Resized(lw, lh));
    }
    std::vector<double> z;
    for (int p : im.point_indices) z.push_back((im.camera.rotation * ws.Model().points[p] + im.camera.translation).z());
    std::sort(z.begin(), z.end());
    opt[i].depth_min = 0.75 * z[z.size() / 100];
    opt[i].depth_max = 1.25 * z[z.size() - 1 - z.size() / 100];
    opt[i].num_iterations = iters;
    opt[i].geometric_weight = EnvF("GW", 0.2);
  }
  std::vector<DeviceImage<float>> depth(n), next_depth(n), filtered(n);
  std::vector<DeviceImage<Vec3f>> normal(n);
  auto to_maps = [&](size_t i, const PlaneHypotheses& h) {
    Image<Plane> p = h.planes.ToHost();
    Image<float> d(p.Width(), p.Height());
    Image<Vec3f> nn(p.Width(), p.Height());
    Intrinsics k = cam[i][0].GetIntrinsics();
    for (int y = 0; y < p.Height(); ++y) for (int x = 0; x < p.Width(); ++x) { d(x, y) = p(x, y).Valid() ? p(x, y).Depth(k.Ray(x, y)) : 0.f; nn(x, y) = p(x, y).normal; }
    next_depth[i] = DeviceImage<float>(*device, d);
    normal[i] = DeviceImage<Vec3f>(*device, nn);
  };
  auto write = [&](size_t i, const Image<float>& d, const char* type) {
    Image<float> dd = d; Image<Vec3f> nn = normal[i].ToHost();
    for (size_t k = 0; k < dd.NumPixels(); ++k) { if (!(dd.Data()[k] > 0 && std::isfinite(dd.Data()[k]))) { dd.Data()[k] = 0; nn.Data()[k] = {}; } }
    const std::string name = ws.Model().images[i].name + "." + type + ".bin";
    std::filesystem::create_directories((out / "stereo/depth_maps" / name).parent_path());
    std::filesystem::create_directories((out / "stereo/normal_maps" / name).parent_path());
    WriteDepthMap(out / "stereo/depth_maps" / name, dd);
    WriteNormalMap(out / "stereo/normal_maps" / name, nn);
  };
  auto t0 = Clock::now();
  const int max_sources = Env("SOURCES", 20);
  for (const auto& problem : ws.Problems()) {
    const size_t i = problem.reference;
    DeviceImage<Plane> planes;
    PlaneHypotheses hyp;
    for (int l = num_levels - 1; l >= 0; --l) {
      ReferenceView ref{cam[i][l].GetIntrinsics(), gray[i][l].View(), {}, {}};
      std::vector<SourceView> src;
      for (int s : problem.sources) if ((int)src.size() < max_sources) src.push_back({cam[s][l].GetIntrinsics(), ComputeRelativePose(cam[i][l], cam[s][l]), gray[s][l].View(), {}});
      Buffer<SourceView> sb(*device, src);
      int w = gray[i][l].Width(), h = gray[i][l].Height();
      planes = l == num_levels - 1 ? DrawPlanes(ref.intrinsics, w, h, 77 + i, opt[i], *device) : ResizePlanes(hyp.planes.View(), w, h, *device);
      hyp = RunPatchMatch({ref, sb, uint32_t(1000 * l + i)}, std::move(planes), opt[i], *device);
    }
    to_maps(i, hyp);
  }
  printf("photometric %.3f s per image\n", std::chrono::duration<double>(Clock::now() - t0).count() / n);
  depth.swap(next_depth);
  for (size_t i = 0; i < n; ++i) write(i, depth[i].ToHost(), "photometric");
  t0 = Clock::now();
  for (int pass = 0; pass < geo_passes; ++pass) {
    for (const auto& problem : ws.Problems()) {
      const size_t i = problem.reference;
      ReferenceView ref{cam[i][0].GetIntrinsics(), gray[i][0].View(), {}, {}};
      std::vector<SourceView> src;
      for (int s : problem.sources) if ((int)src.size() < max_sources) src.push_back({cam[s][0].GetIntrinsics(), ComputeRelativePose(cam[i][0], cam[s][0]), gray[s][0].View(), depth[s].View()});
      Buffer<SourceView> sb(*device, src);
      auto o = opt[i]; o.num_iterations = geo_iters;
      auto planes = PlanesFromMaps(ref.intrinsics, depth[i].View(), normal[i].View(), *device);
      auto hyp = RunPatchMatch({ref, sb, uint32_t(100000 * (pass + 1) + i)}, std::move(planes), o, *device);
      to_maps(i, hyp);
    }
    depth.swap(next_depth);
  }
  for (const auto& problem : ws.Problems()) {
    const size_t i = problem.reference;
    ReferenceView ref{cam[i][0].GetIntrinsics(), gray[i][0].View(), depth[i].View(), normal[i].View()};
    std::vector<SourceView> src;
    for (int s : problem.sources) if ((int)src.size() < max_sources) src.push_back({cam[s][0].GetIntrinsics(), ComputeRelativePose(cam[i][0], cam[s][0]), gray[s][0].View(), depth[s].View()});
    Buffer<SourceView> sb(*device, src);
    write(i, FilterHypotheses(ref, sb, {}, *device).ToHost(), "geometric");
  }
  printf("geometric %.3f s per image\n", std::chrono::duration<double>(Clock::now() - t0).count() / n);
}
