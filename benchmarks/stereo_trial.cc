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
#include <utility>
using namespace tsar;
using Clock = std::chrono::steady_clock;
static int Env(const char* n, int d) { const char* s = getenv(n); return s ? atoi(s) : d; }
static double EnvF(const char* n, double d) { const char* s = getenv(n); return s ? atof(s) : d; }
struct Level { int width, height; std::vector<DeviceImage<float>> gray; };
int main(int, char** argv) {
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
  std::vector<DeviceImage<float>> depth(n);

  auto t0 = Clock::now();
  const int max_sources = Env("SOURCES", 20);
  const int coarse_geo = Env("CGEO", 2);
  std::vector<DeviceImage<Plane>> planes(n);
  auto sources_of = [&](const StereoProblem& problem, int l, bool with_depth) {
    std::vector<SourceView> src;
    for (int s : problem.sources) if ((int)src.size() < max_sources)
      src.push_back({cam[s][l].GetIntrinsics(), ComputeRelativePose(cam[problem.reference][l], cam[s][l]), gray[s][l].View(), with_depth ? std::as_const(depth[s]).View() : ImageView<const float>{}});
    return src;
  };
  auto update_depth = [&](int l) {
    for (size_t i = 0; i < n; ++i) {
      if (planes[i].Empty()) continue;
      Image<Plane> p = planes[i].ToHost();
      Image<float> d(p.Width(), p.Height());
      Intrinsics k = cam[i][l].GetIntrinsics();
      for (int y = 0; y < p.Height(); ++y) for (int x = 0; x < p.Width(); ++x) d(x, y) = p(x, y).Valid() ? p(x, y).Depth(k.Ray(x, y)) : 0.f;
      depth[i] = DeviceImage<float>(*device, d);
    }
  };
  double seconds = 0;
  for (int l = num_levels - 1; l >= 0; --l) {
    const bool coarsest = l == num_levels - 1;
    if (!coarsest) {
      for (size_t i = 0; i < n; ++i) if (!planes[i].Empty()) planes[i] = ResizePlanes(std::as_const(planes[i]).View(), gray[i][l].Width(), gray[i][l].Height(), *device);
      update_depth(l);
    }
    const int fine_iters = Env("FITERS", iters);
    const int passes = 1 + (l == 0 ? geo_passes : coarse_geo);
    for (int pass = 0; pass < passes; ++pass) {
      const bool photo = pass == 0 && (coarsest || fine_iters > 0);
      if (pass == 0 && !photo) continue;
      std::vector<DeviceImage<Plane>> next(n);
      t0 = Clock::now();
      for (const auto& problem : ws.Problems()) {
        const size_t i = problem.reference;
        Buffer<SourceView> sb(*device, sources_of(problem, l, !photo));
        ReferenceView ref{cam[i][l].GetIntrinsics(), gray[i][l].View(), {}, {}};
        auto o = opt[i];
        o.num_iterations = photo ? (coarsest ? iters : fine_iters) : geo_iters;
        o.num_past_iterations = pass == 0 ? (coarsest ? 0 : Env("FPAST", 0)) : Env("PAST", 3) + geo_iters * (pass - 1);
        const int w = gray[i][l].Width(), h = gray[i][l].Height();
        DeviceImage<Plane> start = photo && coarsest ? DrawPlanes(ref.intrinsics, w, h, 77 + i, o, *device) : ResizePlanes(std::as_const(planes[i]).View(), w, h, *device);
        next[i] = RunPatchMatch({ref, sb, uint32_t(10000 * l + 1000 * pass + i)}, std::move(start), o, *device).planes;
      }
      device->Synchronize();
      seconds += std::chrono::duration<double>(Clock::now() - t0).count();
      planes.swap(next);
      if (l > 0 || pass + 1 < passes || getenv("FINALDEPTH")) update_depth(l);
    }
  }
  printf("match %.3f s per image\n", seconds / n);
  t0 = Clock::now();
  std::vector<DeviceImage<float>> filtered(n);
  for (const auto& problem : ws.Problems()) {
    const size_t i = problem.reference;
    Image<Plane> p = planes[i].ToHost();
    Image<float> d(p.Width(), p.Height());
    Image<Vec3f> nn(p.Width(), p.Height());
    Intrinsics k = cam[i][0].GetIntrinsics();
    for (int y = 0; y < p.Height(); ++y) for (int x = 0; x < p.Width(); ++x) { d(x, y) = p(x, y).Valid() ? p(x, y).Depth(k.Ray(x, y)) : 0.f; nn(x, y) = p(x, y).normal; }
    DeviceImage<float> dd(*device, d);
    DeviceImage<Vec3f> nd(*device, nn);
    ReferenceView ref{k, gray[i][0].View(), std::as_const(dd).View(), std::as_const(nd).View()};
    Buffer<SourceView> sb(*device, sources_of(problem, 0, true));
    HypothesisFilterOptions fo;
    fo.min_num_consistent = Env("MINCONS", 2);
    fo.min_ncc = EnvF("MINNCC", 0.1);
    fo.geom_consistency_max_cost = EnvF("MAXGEO", 1.0);
    Image<float> f = FilterHypotheses(ref, sb, fo, *device).ToHost();
    if (const int r = Env("NS", 0)) {
      Image<Vec3f> sm = nn;
      for (int y = 0; y < p.Height(); ++y) for (int x = 0; x < p.Width(); ++x) {
        if (!(f(x, y) > 0)) continue;
        Vec3f sum{0, 0, 0};
        for (int v = std::max(0, y - r); v <= std::min(p.Height() - 1, y + r); ++v) for (int u = std::max(0, x - r); u <= std::min(p.Width() - 1, x + r); ++u)
          if (f(u, v) > 0 && std::abs(p(x, y).Depth(k.Ray(u, v)) - d(u, v)) < 0.01f * d(u, v) && Dot(nn(x, y), nn(u, v)) > 0.7f) sum = sum + nn(u, v);
        sm(x, y) = Normalized(sum);
      }
      nn = sm;
    }
    auto write = [&](Image<float> m, const char* type) {
      Image<Vec3f> nm = nn;
      for (size_t j = 0; j < m.NumPixels(); ++j) if (!(m.Data()[j] > 0 && std::isfinite(m.Data()[j]))) { m.Data()[j] = 0; nm.Data()[j] = {}; }
      const std::string name = ws.Model().images[i].name + "." + type + ".bin";
      std::filesystem::create_directories((out / "stereo/depth_maps" / name).parent_path());
      std::filesystem::create_directories((out / "stereo/normal_maps" / name).parent_path());
      WriteDepthMap(out / "stereo/depth_maps" / name, m);
      WriteNormalMap(out / "stereo/normal_maps" / name, nm);
    };
    write(d, "photometric");
    write(f, "geometric");
  }
  printf("filter %.3f s per image\n", std::chrono::duration<double>(Clock::now() - t0).count() / n);
}
