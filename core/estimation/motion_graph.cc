#include "core/estimation/motion_graph.h"

#include <ceres/covariance.h>
#include <ceres/crs_matrix.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <utility>

#include "core/estimation/graph_blocks.h"
#include "core/estimation/scaled_loss.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"

namespace rgbd_pose {
namespace {

// Each stage of a graduation narrows losses by this factor. They start no wider
// than so many times their widths: beyond that even least squares is no help.
constexpr double kNarrowing = 2.0;
constexpr double kWidest = 1024.0;

// A stage before the last one need not settle.
constexpr int kIterationsPerEarlyStage = 3;

// The world as a pose, that priors are edges from.
constexpr int kWorld = 0;

}  // namespace

std::string MotionGraphOptions::Check() const {
  if (max_rounds < 1) return "max_rounds must be at least 1";
  if (!(settled_within > 0.0)) return "settled_within must be positive";
  if (max_iterations < 1) return "max_iterations must be at least 1";
  if (!(max_standard_deviation > 0.0)) {
    return "max_standard_deviation must be positive";
  }
  if (threads < 1) return "threads must be at least 1";
  return "";
}

const char* ToString(GraphStatus status) {
  switch (status) {
    case GraphStatus::kOk:
      return "ok";
    case GraphStatus::kBadInput:
      return "bad_input";
    case GraphStatus::kNotAnchored:
      return "not_anchored";
    case GraphStatus::kSingular:
      return "singular";
    case GraphStatus::kNotConverged:
      return "not_converged";
  }
  return "";
}

class MotionGraph::Impl {
 public:
  explicit Impl(const MotionGraphOptions& options) : options_(options) {
    const std::string error = options.Check();
    if (!error.empty()) throw InputError("motion graph: " + error);
    poses_.push_back({Rigid3d(), true});
  }

  // Numbers within are one larger: the world is the first pose.
  struct Pose {
    Rigid3d world_from_cam;
    bool is_fixed = false;
  };
  struct EdgeOf {
    int ref = 0, cur = 0;
    Rigid3d cur_from_ref;
    MotionMatrix root;  // see SquareRootOf
    const ceres::LossFunction* loss = nullptr;
  };
  struct Live {
    int ref = 0, cur = 0;
    std::unique_ptr<RobustTerms> terms;
  };

  void Add(int ref, int cur, const Rigid3d& motion, const MotionMatrix& root,
           const ceres::LossFunction* loss) {
    edges_.push_back({ref, cur, motion, root, loss});
  }
  void AddPair(int ref, int cur, const PairData& pair,
               std::vector<RobustCost> costs) {
    live_.push_back(
        {ref, cur, std::make_unique<RobustTerms>(std::move(costs))});
    if (!Takes(ref) || !Takes(cur)) return;  // see CheckInput
    live_.back().terms->Bind(pair, Between(ref, cur));
  }

  GraphSolution Solve();
  double SquaredNorm(const EdgeOf& edge) const;
  std::vector<MotionMatrix> Covariances(const std::vector<int>& poses);

  std::vector<Pose> poses_;
  std::vector<EdgeOf> edges_;
  std::vector<int> edge_numbers_;  // of what AddEdge has returned
  std::vector<Live> live_;

 private:
  // A Ceres problem about the present poses, and what it refers to.
  struct Built {
    std::vector<MotionOrigin> origins;
    std::vector<MotionVector> x;
    std::deque<ScaledLoss> losses;
    std::deque<MotionOrigin> motions;                   // of live pairs
    std::vector<std::unique_ptr<ceres::Problem>> live;  // own their blocks
    std::unique_ptr<ceres::Problem> problem;
  };

  Rigid3d Between(int ref, int cur) const {
    return poses_[cur].world_from_cam.Inverse() * poses_[ref].world_from_cam;
  }
  bool Takes(int pose) const {
    return pose >= 0 && pose < static_cast<int>(poses_.size());
  }
  bool IsIdle(int ref, int cur) const {
    return poses_[ref].is_fixed && poses_[cur].is_fixed;
  }

  bool CheckInput(GraphSolution* solution) const;
  bool CheckAnchors(GraphSolution* solution) const;
  bool CheckDetermined(ceres::Problem* problem, const Built& built,
                       GraphSolution* solution) const;
  std::unique_ptr<Built> Build(double width) const;
  void AddLive(const Live& pair, Built* built) const;
  // One round at a width of the losses; by how much a pose moved at most (rad
  // and m), or NaN if the solver gave up.
  double Round(double width, int max_iterations, GraphSolution* solution);
  double FirstWidth() const;

  const MotionGraphOptions options_;
};

double MotionGraph::Impl::SquaredNorm(const EdgeOf& edge) const {
  const Rigid3d motion = Between(edge.ref, edge.cur);
  RelativeMotion pair;
  pair.motion = {motion.rotation.toRotationMatrix(),
                 motion.Inverse().translation};
  return EdgeTerm::Of(edge.cur_from_ref, edge.root)
      .ResidualAt(pair, nullptr)
      .squaredNorm();
}

bool MotionGraph::Impl::CheckInput(GraphSolution* solution) const {
  solution->status = GraphStatus::kBadInput;
  for (size_t i = 1; i < poses_.size(); ++i) {
    if (poses_[i].world_from_cam.IsFinite()) continue;
    solution->reason = "pose " + std::to_string(i - 1) + " is not finite";
    return false;
  }
  const auto name = [](int ref, int cur) {
    return ref == kWorld ? "the prior of pose " + std::to_string(cur - 1)
                         : "the edge from pose " + std::to_string(ref - 1) +
                               " to pose " + std::to_string(cur - 1);
  };
  for (const EdgeOf& edge : edges_) {
    solution->reason = name(edge.ref, edge.cur);
    if (!Takes(edge.ref) || !Takes(edge.cur) || edge.ref == edge.cur) {
      solution->reason += " is not between two poses of the graph";
    } else if (!edge.cur_from_ref.IsFinite()) {
      solution->reason += " has a motion that is not finite";
    } else if (!edge.root.allFinite()) {
      solution->reason += " has a covariance that is none";
    } else {
      continue;
    }
    return false;
  }
  for (const Live& pair : live_) {
    if (Takes(pair.ref) && Takes(pair.cur) && pair.ref != pair.cur) continue;
    solution->reason = "a live pair is not between two poses of the graph";
    return false;
  }
  solution->status = GraphStatus::kOk;
  solution->reason.clear();
  return true;
}

// Poses that hang together, by the smallest number among them (union-find).
bool MotionGraph::Impl::CheckAnchors(GraphSolution* solution) const {
  std::vector<int> root(poses_.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int pose) {
    while (root[pose] != pose) pose = root[pose] = root[root[pose]];
    return pose;
  };
  const auto join = [&](int a, int b) {
    a = find(a);
    b = find(b);
    root[std::max(a, b)] = std::min(a, b);
  };
  for (const EdgeOf& edge : edges_) join(edge.ref, edge.cur);
  for (const Live& pair : live_) join(pair.ref, pair.cur);
  for (size_t i = 0; i < poses_.size(); ++i) {
    if (poses_[i].is_fixed) join(kWorld, static_cast<int>(i));
  }
  for (size_t i = 0; i < poses_.size(); ++i) {
    if (find(static_cast<int>(i)) == kWorld) continue;
    solution->status = GraphStatus::kNotAnchored;
    solution->reason = "pose " + std::to_string(i - 1) +
                       " and those joined to it hang on nothing that is fixed";
    return false;
  }
  return true;
}

std::unique_ptr<MotionGraph::Impl::Built> MotionGraph::Impl::Build(
    double width) const {
  auto built = std::make_unique<Built>();
  built->x.assign(poses_.size(), MotionVector::Zero());
  built->origins.reserve(poses_.size());
  for (const Pose& pose : poses_) {
    built->origins.emplace_back(pose.world_from_cam.Inverse());
  }
  ceres::Problem::Options options;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;  // see CheckInput
  built->problem = std::make_unique<ceres::Problem>(options);
  for (size_t i = 0; i < poses_.size(); ++i) {
    if (!poses_[i].is_fixed) {
      built->problem->AddParameterBlock(built->x[i].data(), 6);
    }
  }
  for (const EdgeOf& edge : edges_) {
    if (IsIdle(edge.ref, edge.cur)) continue;
    ceres::LossFunction* loss = nullptr;
    if (edge.loss != nullptr) {
      loss = &built->losses.emplace_back(edge.loss, width);
    }
    const EdgeTerm term = EdgeTerm::Of(edge.cur_from_ref, edge.root);
    const MotionOrigin* ref = &built->origins[edge.ref];
    const MotionOrigin* cur = &built->origins[edge.cur];
    built->problem->AddResidualBlock(options_.assembly == Assembly::kAutodiff
                                         ? MakeEdgeOracle(term, ref, cur)
                                         : new EdgeBlock(term, ref, cur),
                                     loss, built->x[edge.ref].data(),
                                     built->x[edge.cur].data());
  }
  for (const Live& pair : live_) {
    if (!IsIdle(pair.ref, pair.cur)) AddLive(pair, built.get());
  }
  for (size_t i = 0; i < poses_.size(); ++i) {
    double* const x = built->x[i].data();
    if (poses_[i].is_fixed && built->problem->HasParameterBlock(x)) {
      built->problem->SetParameterBlockConstant(x);
    }
  }
  return built;
}

// The costs make their blocks for a problem of one motion; each becomes one of
// two poses.
void MotionGraph::Impl::AddLive(const Live& pair, Built* built) const {
  const MotionOrigin& motion =
      built->motions.emplace_back(Between(pair.ref, pair.cur));
  ceres::Problem::Options options;
  options.cost_function_ownership = BlockOwnership(options_.assembly);
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem* const alone =
      built->live.emplace_back(std::make_unique<ceres::Problem>(options)).get();
  MotionVector x = MotionVector::Zero();
  pair.terms->AddTo(options_.assembly, motion, x.data(), alone);
  std::vector<ceres::ResidualBlockId> blocks;
  alone->GetResidualBlocks(&blocks);
  for (const ceres::ResidualBlockId block : blocks) {
    built->problem->AddResidualBlock(
        new LiveBlock(alone->GetCostFunctionForResidualBlock(block), &motion,
                      &built->origins[pair.ref], &built->origins[pair.cur],
                      options_.assembly == Assembly::kAutodiff),
        const_cast<ceres::LossFunction*>(
            alone->GetLossFunctionForResidualBlock(block)),
        built->x[pair.ref].data(), built->x[pair.cur].data());
  }
}

double MotionGraph::Impl::FirstWidth() const {
  double largest = 0.0;
  for (const EdgeOf& edge : edges_) {
    if (edge.loss != nullptr && !IsIdle(edge.ref, edge.cur)) {
      largest = std::max(largest, SquaredNorm(edge));
    }
  }
  return std::clamp(std::sqrt(largest), 1.0, kWidest);
}

double MotionGraph::Impl::Round(double width, int max_iterations,
                                GraphSolution* solution) {
  const std::unique_ptr<Built> built = Build(width);
  if (built->problem->NumResidualBlocks() == 0) return 0.0;
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = max_iterations;
  options.num_threads = options_.threads;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-9;
  // An origin is near by: steps need no damping to begin with.
  options.initial_trust_region_radius = 1e8;
  ceres::Solver::Summary summary;
  ceres::Solve(options, built->problem.get(), &summary);
  solution->iterations += static_cast<int>(summary.iterations.size());
  ++solution->rounds;
  solution->final_cost = summary.final_cost;
  if (!summary.IsSolutionUsable()) {
    solution->status = GraphStatus::kNotConverged;
    solution->reason = "the solver gave up: " + summary.message;
    return std::nan("");
  }
  double moved = 0.0;
  for (size_t i = 0; i < poses_.size(); ++i) {
    if (poses_[i].is_fixed) continue;
    moved = std::max(moved, built->x[i].lpNorm<Eigen::Infinity>());
    poses_[i].world_from_cam =
        built->origins[i].CurFromPrev(built->x[i].data()).Inverse();
  }
  return moved;
}

GraphSolution MotionGraph::Impl::Solve() {
  GraphSolution solution;
  if (!CheckInput(&solution) || !CheckAnchors(&solution)) return solution;
  const std::vector<Pose> before = poses_;
  {
    const std::unique_ptr<Built> built = Build(1.0);
    built->problem->Evaluate({}, &solution.initial_cost, nullptr, nullptr,
                             nullptr);
  }
  solution.final_cost = solution.initial_cost;
  if (options_.graduated) {
    for (double width = FirstWidth(); width > 1.0; width /= kNarrowing) {
      if (std::isnan(Round(width, kIterationsPerEarlyStage, &solution))) break;
    }
  }
  for (int round = 0; round < options_.max_rounds && solution.ok(); ++round) {
    for (const Live& pair : live_) {
      pair.terms->Associate(Association::kWhenMoved,
                            Between(pair.ref, pair.cur));
    }
    const double moved = Round(1.0, options_.max_iterations, &solution);
    if (!(moved > options_.settled_within)) break;
  }
  if (solution.ok()) {
    const std::unique_ptr<Built> built = Build(1.0);
    CheckDetermined(built->problem.get(), *built, &solution);
  }
  if (!solution.ok()) poses_ = before;
  return solution;
}

// The pivots of a Cholesky decomposition are the information of one parameter,
// those eliminated before it taken as unknown and those after as known: an
// upper limit of what is known of it, reached by the last.
bool MotionGraph::Impl::CheckDetermined(ceres::Problem* problem,
                                        const Built& built,
                                        GraphSolution* solution) const {
  if (problem->NumResidualBlocks() == 0) return true;
  ceres::Problem::EvaluateOptions evaluate;
  std::vector<int> of;  // of each six columns the pose
  for (size_t i = 0; i < poses_.size(); ++i) {
    if (poses_[i].is_fixed) continue;
    evaluate.parameter_blocks.push_back(const_cast<double*>(built.x[i].data()));
    of.push_back(static_cast<int>(i) - 1);
  }
  ceres::CRSMatrix crs;
  problem->Evaluate(evaluate, nullptr, nullptr, nullptr, &crs);
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
  const Eigen::Map<const Sparse> J(
      crs.num_rows, crs.num_cols, static_cast<int>(crs.values.size()),
      crs.rows.data(), crs.cols.data(), crs.values.data());
  const Eigen::SparseMatrix<double> H = J.transpose() * J;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> ldlt(H);
  const double least =
      1.0 / (options_.max_standard_deviation * options_.max_standard_deviation);
  const Eigen::VectorXd pivots = ldlt.vectorD();
  for (int k = 0; k < pivots.size(); ++k) {
    if (ldlt.info() == Eigen::Success && pivots[k] >= least) continue;
    const int column = ldlt.permutationPinv().indices()[k];
    solution->status = GraphStatus::kSingular;
    solution->reason =
        "pose " + std::to_string(of[column / 6]) + " is not determined";
    return false;
  }
  return true;
}

std::vector<MotionMatrix> MotionGraph::Impl::Covariances(
    const std::vector<int>& poses) {
  const std::unique_ptr<Built> built = Build(1.0);
  ceres::Covariance::Options options;
  options.num_threads = options_.threads;
  ceres::Covariance covariance(options);
  std::vector<std::pair<const double*, const double*>> wanted;
  for (const int pose : poses) {
    const double* x = built->x[pose].data();
    if (!poses_[pose].is_fixed) wanted.emplace_back(x, x);
  }
  if (!wanted.empty() && !covariance.Compute(wanted, built->problem.get())) {
    return {};
  }
  std::vector<MotionMatrix> result;
  for (const int pose : poses) {
    Eigen::Matrix<double, 6, 6, Eigen::RowMajor> block;
    block.setZero();
    const double* x = built->x[pose].data();
    if (!poses_[pose].is_fixed) {
      covariance.GetCovarianceBlock(x, x, block.data());
    }
    result.push_back(block);
  }
  return result;
}

MotionGraph::MotionGraph(const MotionGraphOptions& options)
    : impl_(std::make_unique<Impl>(options)) {}
MotionGraph::~MotionGraph() = default;
MotionGraph::MotionGraph(MotionGraph&&) noexcept = default;
MotionGraph& MotionGraph::operator=(MotionGraph&&) noexcept = default;

int MotionGraph::AddPose(const Rigid3d& world_from_cam, bool is_fixed) {
  impl_->poses_.push_back({world_from_cam, is_fixed});
  return num_poses() - 1;
}

int MotionGraph::AddEdge(const Edge& edge, const ceres::LossFunction* loss) {
  // A covariance without an inverse has no finite root either.
  impl_->edge_numbers_.push_back(static_cast<int>(impl_->edges_.size()));
  impl_->Add(edge.ref + 1, edge.cur + 1, edge.cur_from_ref,
             SquareRootOf(edge.covariance.inverse()), loss);
  return static_cast<int>(impl_->edge_numbers_.size()) - 1;
}

void MotionGraph::AddPrior(int pose, const MotionPrior& prior,
                           const ceres::LossFunction* loss) {
  impl_->Add(kWorld, pose + 1, prior.mean, SquareRootOf(prior.information),
             loss);
}

void MotionGraph::AddPair(int ref, int cur, const PairData& pair,
                          std::vector<RobustCost> costs) {
  impl_->AddPair(ref + 1, cur + 1, pair, std::move(costs));
}

void MotionGraph::SetPose(int pose, const Rigid3d& world_from_cam) {
  impl_->poses_[pose + 1].world_from_cam = world_from_cam;
}

void MotionGraph::SetFixed(int pose, bool is_fixed) {
  impl_->poses_[pose + 1].is_fixed = is_fixed;
}

GraphSolution MotionGraph::Solve() { return impl_->Solve(); }

int MotionGraph::num_poses() const {
  return static_cast<int>(impl_->poses_.size()) - 1;
}

const Rigid3d& MotionGraph::pose(int pose) const {
  return impl_->poses_[pose + 1].world_from_cam;
}

double MotionGraph::SquaredNormOf(int edge) const {
  return impl_->SquaredNorm(impl_->edges_[impl_->edge_numbers_[edge]]);
}

std::vector<MotionMatrix> MotionGraph::Covariances(
    const std::vector<int>& poses) const {
  std::vector<int> within;
  for (const int pose : poses) within.push_back(pose + 1);
  return impl_->Covariances(within);
}

double MotionGraph::Redundancy() const {
  const auto motions = static_cast<double>(num_poses() - 1);
  const auto pairs =
      static_cast<double>(impl_->edge_numbers_.size() + impl_->live_.size());
  return motions > 0.0 ? std::max(1.0, pairs / motions) : 1.0;
}

}  // namespace rgbd_pose
