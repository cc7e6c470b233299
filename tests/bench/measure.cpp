#include "tests/bench/measure.h"

#include <chrono>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "tests/support/brute_force_pair.h"

namespace bench {
namespace {

constexpr double most_pairs_tried = 2e8;
constexpr double least_seconds = 0.01; // per repetition
constexpr size_t stretch = 50; // consecutive poses that even the slowest engine follows on a path

/// An engine with the structures of the scene's two bodies.
struct Ready {
    const Contestant* contestant;
    Prepared prepared;
};

template <typename Function>
double seconds_of(const Function& function) {
    const auto start = std::chrono::steady_clock::now();
    function();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Runs a query and stops on a wrong result. Returns the time it took.
double checked(const Ready& ready, const std::string& name, const Pose& pose,
               const core::PairGoal& goal, double truth) {
    double answer = 0.0;
    const double seconds = seconds_of([&] { answer = ready.prepared.cold(pose.a_from_b, goal); });
    const bool any = goal.any && truth < goal.limit;
    const double precision = ready.contestant->precision;
    const bool right = any                 ? answer >= truth - precision && answer < goal.limit
                       : std::isinf(truth) ? std::isinf(answer)
                                           : std::abs(answer - truth) <= precision;
    if (!right)
        throw std::runtime_error(fmt::format("{} says {:.17g} mm at {}, where {:.17g} is right",
                                             ready.contestant->name, answer, name, truth));
    return seconds;
}

/// The distance that all must find.
double truth_of(const Bodies& bodies, const Query& exact, const Pose& pose, double limit) {
    const double truth = exact(pose.a_from_b, {});
    const double pairs =
        static_cast<double>(bodies.a.size()) * static_cast<double>(bodies.b.size());
    if (pairs <= most_pairs_tried) {
        const double tried = test_support::brute_force_distance(bodies.a, bodies.b, pose.a_from_b);
        if (truth != tried)
            throw std::runtime_error(
                fmt::format("{:.17g} mm is what the paper's engine says at {}, {:.17g} what all "
                            "pairs of points say",
                            truth, pose.name, tried));
    }
    if (truth >= limit) return core::infinity;
    return truth;
}

/// The number of repetitions for a duration: more for fast queries, which suffer most from noise.
int repetitions_of(double seconds) {
    return seconds < 0.02 ? 15 : seconds < 0.5 ? 7 : seconds < 2.0 ? 3 : 1;
}

benchmark::internal::Benchmark* registered(const std::string& name, double seconds,
                                           const std::function<void(benchmark::State&)>& run) {
    return benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMicrosecond)
        ->MeasureProcessCPUTime()
        ->Repetitions(repetitions_of(seconds));
}

/// A query repeated at one pose: caches and branch predictors are warm.
double register_pose(const Ready& ready, const Row& row, const Pose& pose, double truth) {
    const std::string name = row.name + "/" + pose.name + "/" + ready.contestant->name;
    const double seconds = checked(ready, name, pose, row.goal, truth);
    const auto run = [&query = ready.prepared.cold, pose = pose.a_from_b,
                      goal = row.goal](benchmark::State& state) {
        for (auto step : state) benchmark::DoNotOptimize(query(pose, goal));
    };
    registered(name, seconds, run)->MinTime(least_seconds);
    return seconds;
}

/// All poses in turn, so that each finds the caches as another one left them.
void register_in_turn(const Ready& ready, const Row& row, double seconds) {
    const auto run = [&query = ready.prepared.cold, row](benchmark::State& state) {
        for (auto step : state)
            for (const Pose& pose : row.poses)
                benchmark::DoNotOptimize(query(pose.a_from_b, row.goal));
    };
    registered(row.name + "/in-turn/" + ready.contestant->name, seconds, run)
        ->MinTime(least_seconds);
}

void register_row(const Row& row, const Bodies& bodies, const std::vector<Ready>& all) {
    std::vector<double> seconds(all.size(), 0.0);
    for (const Pose& pose : row.poses) {
        const double truth = truth_of(bodies, all.front().prepared.cold, pose, row.goal.limit);
        for (size_t i = 0; i < all.size(); ++i)
            seconds[i] += register_pose(all[i], row, pose, truth);
    }
    for (size_t i = 0; row.in_turn && i < all.size(); ++i)
        register_in_turn(all[i], row, seconds[i]);
}

void register_build(const Scene& scene, const Bodies& bodies, const std::vector<Ready>& all) {
    for (const Ready& ready : all) {
        const auto& build = ready.contestant->build;
        const auto run = [&build, &points = bodies.a](benchmark::State& state) {
            for (auto step : state) {
                std::shared_ptr<const void> built = build(points);
                state.PauseTiming(); // destruction is not part of building
                built.reset();
                state.ResumeTiming();
            }
        };
        const std::string name = "build-" + scene.name + "/A/" + ready.contestant->name;
        const double seconds = seconds_of([&] { build(bodies.a); });
        registered(name, seconds, run)->MinTime(least_seconds);
    }
}

/// The number of the `i`th pose for an engine that follows `count` poses: stretches spread evenly
/// over the path.
size_t on_path(size_t path_size, size_t count, size_t i) {
    return i / stretch * stretch * (path_size / count) + i % stretch;
}

/// The number of poses that an engine follows: all, if it needs less than a second for them.
size_t poses_for(const Ready& ready, const std::vector<core::Transform>& path) {
    const double cold = seconds_of([&] { ready.prepared.cold(path[path.size() / 2], {}); });
    size_t count = path.size();
    while (count > 5 * stretch && cold * static_cast<double>(count) > 1.0) count /= 2;
    return count / stretch * stretch;
}

void check_path(const Ready& ready, const std::vector<core::Transform>& path, size_t count,
                const Query& exact) {
    const Query query = ready.prepared.follow();
    for (size_t i = 0; i < count; ++i) {
        const core::Transform& pose = path[on_path(path.size(), count, i)];
        const double answer = query(pose, {});
        if (i % (count / 125) == 0 && answer != exact(pose, {}))
            throw std::runtime_error(
                fmt::format("{} is wrong at pose {} of the path", ready.contestant->name, i));
    }
}

void register_path(const Scene& scene, const std::vector<Ready>& all) {
    for (const Ready& ready : all) {
        if (!ready.prepared.follow || scene.path.empty()) continue;
        const size_t count = poses_for(ready, scene.path);
        check_path(ready, scene.path, count, all.front().prepared.cold);
        const auto run = [&ready, &path = scene.path, count](benchmark::State& state) {
            const Query query = ready.prepared.follow();
            size_t i = 0;
            for (auto step : state)
                benchmark::DoNotOptimize(query(path[on_path(path.size(), count, i++)], {}));
        };
        const std::string name = "warm-" + scene.name + "/path/" + ready.contestant->name;
        registered(name, 0.1, run)->Iterations(static_cast<benchmark::IterationCount>(count));
    }
}

} // namespace

void measure(const Scene& scene, const std::vector<Contestant>& contestants,
             benchmark::BenchmarkReporter& reporter) {
    const Bodies bodies = scene.bodies();
    std::vector<Ready> all;
    all.reserve(contestants.size());
    for (const Contestant& contestant : contestants)
        all.push_back({&contestant, contestant.prepare(bodies.a, bodies.b)});
    for (const Row& row : scene.rows(all.front().prepared.cold)) register_row(row, bodies, all);
    if (scene.with_build) register_build(scene, bodies, all);
    register_path(scene, all);
    benchmark::RunSpecifiedBenchmarks(&reporter);
    benchmark::ClearRegisteredBenchmarks();
}

} // namespace bench
