#include "benchmarks/speedups.h"

#include <algorithm>

#include "costs/cost_factory.h"
#include "costs/direct_cost_factory.h"

namespace rgbd_pose {
namespace {

const std::string kMatchPeers[] = {"pnp_ransac", "pnp_ransac_refined",
                                   "umeyama_ransac"};
const std::string kFramePeers[] = {"opencv_rgbd", "opencv_icp",
                                   "opencv_rgbdicp", "open3d_hybrid"};

class Collector {
 public:
  explicit Collector(const BenchmarkResults& results) : results_(results) {}

  void Add(const std::string& key, const std::vector<std::string>& ours,
           const std::vector<std::string>& theirs, double aim = 0.0) {
    const BenchmarkResult* a = results_.FindFastest(ours);
    const BenchmarkResult* b = results_.FindFastest(theirs);
    if (a == nullptr || b == nullptr) return;
    rows_.push_back({key, SpeedupOf(*a, *b), aim});
  }

  const std::vector<SpeedupRow>& rows() const { return rows_; }

 private:
  const BenchmarkResults& results_;
  std::vector<SpeedupRow> rows_;
};

// Aims of a solve; 0: none.
struct SolveAims {
  double autodiff, per_match, bare_loop;
};

void AddSolves(const std::string& key, const std::string& loss, int matches,
               const SolveAims& aims, Collector* collector) {
  const std::string size = std::to_string(matches);
  const auto ours = SolveNames("compressed", loss, matches);
  const auto autodiff = SolveNames("autodiff", loss, matches);
  const auto per_match = SolveNames("per_match", loss, matches);
  collector->Add(key + "_compressed_over_autodiff", ours, autodiff,
                 aims.autodiff);
  collector->Add(key + "_compressed_over_per_match", ours, per_match,
                 aims.per_match);
  collector->Add(key + "_compressed_over_bare_loop", ours,
                 {"solve/bare_loop/" + loss + "/" + size}, aims.bare_loop);
  const char* solvers[] = {"qr", "cholesky"};  // in the order of SolveNames
  for (int i = 0; i < 2; ++i) {
    const std::string same = key + "_" + solvers[i];
    collector->Add(same + "_compressed_over_autodiff", {ours[i]},
                   {autodiff[i], autodiff[i + 2]});
    collector->Add(same + "_compressed_over_per_match", {ours[i]},
                   {per_match[i]});
  }
}

}  // namespace

std::vector<std::string> SolveNames(const std::string& assembly,
                                    const std::string& loss, int matches) {
  const std::string rest = "/" + loss + "/" + std::to_string(matches);
  std::vector<std::string> names = {"solve/" + assembly + "/qr" + rest,
                                    "solve/" + assembly + "/cholesky" + rest};
  if (assembly == "autodiff") {
    names.push_back("solve/plain/qr" + rest);
    names.push_back("solve/plain/cholesky" + rest);
  }
  return names;
}

std::vector<std::string> TrackedSequences(const BenchmarkResults& results) {
  const std::string prefix = "frames/";
  const std::string suffix = "/rgbd_pose";
  std::vector<std::string> sequences;
  for (const auto& [name, result] : results.benchmarks) {
    const size_t end = name.size() - std::min(name.size(), suffix.size());
    if (name.rfind(prefix, 0) != 0 || name.substr(end) != suffix) continue;
    sequences.push_back(name.substr(prefix.size(), end - prefix.size()));
  }
  return sequences;
}

std::vector<SpeedupRow> FindSpeedups(const BenchmarkResults& results) {
  Collector collector(results);
  // Runs on shared machines had 20 to 26 over autodiff: half of the time is
  // that of Ceres, whatever the costs do.
  AddSolves("solve_n300", "huber", 300, {20.0, 15.0, 1.0 / 3.0}, &collector);
  AddSolves("dense_100k", "huber", 100000, {0.0, 20.0, 0.8}, &collector);
  AddSolves("solve_n300_none", "none", 300, {}, &collector);
  AddSolves("solve_n300_tukey", "tukey", 300, {}, &collector);
  const std::string estimate = "estimate/compressed/tukey/300";
  collector.Add("estimate_n300_compressed_over_autodiff", {estimate},
                {"estimate/autodiff/tukey/300"});
  collector.Add("estimate_n300_compressed_over_per_match", {estimate},
                {"estimate/per_match/tukey/300"});
  for (const std::string& cost : CostNames()) {
    const std::string alone = "jacobian/alone/" + cost;
    collector.Add("jacobian_" + cost + "_analytic_over_autodiff",
                  {alone + "/analytic"}, {alone + "/autodiff"},
                  cost == "bidirectional_point" ? 4.0 : 2.0);
  }
  for (const std::string& cost : CostNames()) {
    const std::string in_ceres = "jacobian/in_ceres/" + cost;
    collector.Add("jacobian_in_ceres_" + cost + "_analytic_over_autodiff",
                  {in_ceres + "/analytic"}, {in_ceres + "/autodiff"});
  }
  for (const std::string& cost : DirectCostNames()) {
    const std::string alone = "jacobian/alone/" + cost;
    collector.Add("jacobian_" + cost + "_analytic_over_autodiff",
                  {alone + "/analytic"}, {alone + "/autodiff"}, 2.0);
  }
  collector.Add("direct_photometric_over_bare_loop",
                {"direct/linearise/photometric/10000"},
                {"direct/linearise/bare_loop/10000"}, 1.0 / 1.5);
  for (const std::string size : {"100", "1000"}) {
    collector.Add("graph_" + size + "_edges_over_bundle_adjustment",
                  {"graph/edges/" + size}, {"graph/bundle_adjustment/" + size});
  }
  for (const std::string& peer : kMatchPeers) {
    collector.Add("estimate_over_" + peer, {"peers/estimator"},
                  {"peers/" + peer});
    collector.Add("ransac_over_" + peer, {"peers/ransac"}, {"peers/" + peer});
  }
  for (const std::string& sequence : TrackedSequences(results)) {
    const std::string frames = "frames/" + sequence + "/";
    const bool simulated = sequence.rfind("room_", 0) == 0;
    const std::string key = simulated ? "frame" : "frame_" + sequence;
    for (const std::string& peer : kFramePeers) {
      collector.Add(key + "_over_" + peer, {frames + "rgbd_pose"},
                    {frames + peer});
    }
  }
  return collector.rows();
}

}  // namespace rgbd_pose
