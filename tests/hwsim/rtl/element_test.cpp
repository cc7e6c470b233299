// A search element of the circuit, held against the emulator's at every clock edge.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "ElementCircuit.h"
#include "SmallElementCircuit.h"
#include "tests/hwsim/random_models.h"
#include "tests/hwsim/rtl/fields.h"

namespace hwsim::rtl {
namespace {

/// What two models and their memory are like.
struct Kind {
    int32_t reach = 200'000; // of the records
    int32_t grid = 1;        // everything is a multiple of this
    bool is_pocket = false;  // the work is a ring around the tool
    bool rewrites = false;   // lines are written during searches, some with a later epoch
    bool is_faulty = false; // wrong bits, later epochs, lines beyond the memory, searches cut short
};

std::vector<Record> ring_of_posts(std::mt19937& rng, size_t count, int32_t radius) {
    std::vector<Record> posts;
    for (size_t i = 0; i < count; ++i) {
        const double angle =
            2.0 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(count);
        posts.push_back({{static_cast<int32_t>(radius * std::cos(angle)),
                          static_cast<int32_t>(radius * std::sin(angle)),
                          -static_cast<int32_t>(rng() % 50'000)},
                         40'000,
                         radius / 20});
    }
    return posts;
}

Scene scene_of_kind(std::mt19937& rng, const Kind& kind) {
    const auto cloud = [&](size_t count) {
        std::vector<Record> records(count);
        for (Record& r : records) {
            r = random_record(rng, kind.reach / kind.grid);
            for (int32_t& value : r.base) value *= kind.grid;
            r.run *= kind.grid;
            r.half *= kind.grid;
        }
        return records;
    };
    const std::vector<Record> tools = cloud(1 + rng() % 60);
    const size_t posts = 1 + rng() % 600;
    const std::vector<Record> works =
        kind.is_pocket ? ring_of_posts(rng, posts, 2 * kind.reach) : cloud(posts);
    Scene scene = scene_of(tools, works, {}, beyond_all_squares, 1 + rng() % 32);
    if (!kind.is_faulty) return scene;
    for (uint32_t faults = rng() % 3; faults > 0;) {
        const auto address = static_cast<uint32_t>(rng() % scene.memory.size());
        Line& line = scene.memory[address];
        if (line == Line{}) continue; // is not used
        --faults;
        if (rng() % 2) {
            line.word[rng() % Line::words] ^= 1U << rng() % 32;
        } else {
            line.word[Line::epoch_word] = 2;
            line.word[Line::check_word] = check_of(line, address);
        }
    }
    return scene;
}

Query random_query(std::mt19937& rng, const Kind& kind, const Scene& scene) {
    Query query = scene.query;
    const int32_t far = (1 + static_cast<int32_t>(rng() % 3)) * kind.reach / kind.grid;
    query.segment = random_segment(rng, far, static_cast<uint8_t>(rng() % 13));
    if (rng() % 5 == 0) query.segment.end = query.segment.start;
    for (size_t axis = 0; axis < 3; ++axis) {
        query.segment.start[axis] *= kind.grid;
        query.segment.end[axis] *= kind.grid;
    }
    if (rng() % 50 == 0) query.segment.start[rng() % 3] = greatest_coordinate;
    // Some lines have epoch 2.
    if (rng() % 4 == 0) query.tool_epoch = 2;
    if (rng() % 4 == 0) query.work_epoch = 2;
    const auto near = static_cast<uint32_t>(rng() % static_cast<uint32_t>(kind.reach));
    query.limit = rng() % 2 ? beyond_all_squares : squared_limit(near);
    return query;
}

/// How many searches ended for each reason.
using Tally = std::array<int, stop_count>;

/// An element of the emulator with its memory, and one of the circuit.
template <typename Circuit>
class Lockstep {
public:
    Lockstep(uint32_t seed, const Kind& kind, const DeviceConfig& config)
        : rng_(seed), kind_(kind), scene_(scene_of_kind(rng_, kind)), config_(config) {
        config_.memory_latency = 1 + static_cast<uint32_t>(rng_() % 40);
        config_.cycles_per_line = 1 + static_cast<uint32_t>(rng_() % 3);
        config_.memory_lines = static_cast<uint32_t>(scene_.memory.size());
        if (kind.is_faulty && rng_() % 4 == 0) config_.memory_lines /= 2;
        if (kind.is_faulty && rng_() % 4 == 0) config_.memory_lines = scene_.query.work_header;
        if (kind.is_faulty) config_.search_limit = 100U << rng_() % 8;
        element_ = search_element(config_);
        memory_ = memory_unit(config_);
        std::copy_n(scene_.memory.begin(), config_.memory_lines, memory_.lines.begin());
        queries_.resize(config_.threads);
        was_started_.resize(config_.threads);
        circuit_.memory_lines = config_.memory_lines;
        circuit_.search_limit = config_.search_limit;
        circuit_.reset = 1;
        clock(circuit_);
        circuit_.reset = 0;
        element_.first = 0;
    }

    /// One clock edge of both.
    void step(Tally& tally) {
        ++cycle_;
        const ReadRequest request = accepts(memory_) ? element_.request : ReadRequest{};
        const ReadResponse& arriving = memory_.check.output();
        const SearchStart start = next_start();
        const ThreadRelease release = next_release(tally);
        ElementInput in{.cycle = cycle_,
                        .run = run_,
                        .flush = is_flushing_ || (kind_.is_faulty && rng_() % 2'000 == 0),
                        .granted = request.valid,
                        .forget = memory_.has_written,
                        .forgotten = memory_.written};
        if (arriving.valid) in.response = &arriving;
        if (start.valid) in.start = &start;
        if (release.valid) in.release = &release;
        put(in, arriving.valid && arriving.request.run == run_);
        clock(circuit_);
        const ReadResponse arrived = arriving; // the memory's next edge ends it
        if (in.response) in.response = &arrived;
        tick(element_, config_, in);
        tick(memory_, config_, cycle_, request);
        if (in.flush) ++run_;
        is_flushing_ = false;
        if (kind_.rewrites && rng_() % 24 == 0) rewrite();
    }

    /// Whether both are in the same state, as far as it can be seen.
    void expect_the_same() {
        ASSERT_EQ(circuit_.request != 0, element_.request.valid) << cycle_;
        if (element_.request.valid) {
            ASSERT_EQ(circuit_.request_thread, element_.request.thread);
            ASSERT_EQ(circuit_.request_address, element_.request.address);
        }
        for (uint32_t i = 0; i < config_.threads; ++i) {
            const auto phase = static_cast<uint32_t>(element_.threads[i].phase);
            ASSERT_EQ(circuit_.phases >> (5 * i) & 31U, phase) << cycle_ << " thread " << i;
        }
        const uint32_t shown = circuit_.answer_thread;
        if (!was_started_[shown]) return;
        const Answer& answer = element_.threads[shown].answer;
        Fields fields;
        fields.put(answer);
        ASSERT_TRUE(holds(circuit_.answer, fields)) << cycle_;
    }

private:
    SearchStart next_start() {
        SearchStart start;
        const auto thread = static_cast<uint8_t>(rng_() % config_.threads);
        if (element_.threads[thread].phase != Phase::idle || rng_() % 4 == 0) return start;
        queries_[thread] = random_query(rng_, kind_, scene_);
        was_started_[thread] = true;
        return {.valid = true, .thread = thread, .query = queries_[thread]};
    }

    /// Takes the answer of a thread that is done, at times. A fault stops the device, which drops
    /// all searches.
    ThreadRelease next_release(Tally& tally) {
        const auto thread = static_cast<uint8_t>(rng_() % config_.threads);
        const SearchThread& done = element_.threads[thread];
        if (done.phase != Phase::done || rng_() % 2) return {};
        ++tally[static_cast<size_t>(done.answer.stop)];
        is_flushing_ = done.answer.stop != Stop::none;
        if (!kind_.rewrites && !is_flushing_) {
            EXPECT_EQ(done.answer, search(scene_.memory, queries_[thread], config_.stack_depth));
        }
        return {.valid = true, .thread = thread};
    }

    /// Gives the circuit the inputs of the emulator.
    void put(const ElementInput& in, bool has_response) {
        circuit_.cycle = static_cast<uint32_t>(in.cycle);
        circuit_.flush = in.flush;
        circuit_.granted = in.granted;
        circuit_.forget = in.forget;
        circuit_.forgotten = in.forgotten;
        circuit_.answer_thread = static_cast<uint8_t>(in.cycle % config_.threads);
        circuit_.response = has_response;
        if (in.response) {
            circuit_.response_thread = in.response->request.thread;
            circuit_.response_address = in.response->request.address;
            circuit_.response_is_intact = in.response->is_intact;
            for (size_t w = 0; w < Line::check_word; ++w)
                circuit_.response_line[w] = in.response->line.word[w];
        }
        circuit_.release_valid = in.release != nullptr;
        if (in.release) circuit_.release_thread = in.release->thread;
        circuit_.start = in.start != nullptr;
        if (!in.start) return;
        circuit_.start_thread = in.start->thread;
        Fields fields;
        fields.put(in.start->query);
        set(circuit_.query, fields);
    }

    void rewrite() {
        if (memory_.writes.full()) return;
        const auto address = static_cast<uint32_t>(rng_() % config_.memory_lines);
        Line line = scene_.memory[address];
        if (rng_() % 8 == 0) line.word[Line::epoch_word] = 2;
        line.word[Line::check_word] = check_of(line, address);
        memory_.writes.push({address, line});
    }

    std::mt19937 rng_;
    Kind kind_;
    Scene scene_;
    DeviceConfig config_;
    SearchElement element_;
    MemoryUnit memory_;
    Circuit circuit_;
    std::vector<Query> queries_;
    std::vector<bool> was_started_;
    uint64_t cycle_ = 0;
    uint32_t run_ = 0;
    bool is_flushing_ = false;
};

/// Runs both for so many clock edges, in scenes of 10,000.
template <typename Circuit>
Tally run_in_lockstep(uint32_t seed, const Kind& kind, const DeviceConfig& config, int cycles) {
    Tally tally{};
    constexpr int scene = 10'000;
    for (uint32_t i = 0; cycles > 0; ++i, cycles -= scene) {
        Lockstep<Circuit> both(1'000 * seed + i, kind, config);
        for (int cycle = 0; cycle < std::min(cycles, scene); ++cycle) {
            both.step(tally);
            both.expect_the_same();
            if (::testing::Test::HasFatalFailure()) return tally;
        }
    }
    return tally;
}

const DeviceConfig usual{.memory_queue = 8, .write_queue = 4};
const DeviceConfig small{.threads = 3,
                         .stack_depth = 5,
                         .node_cache_lines = 8,
                         .record_cache_lines = 4,
                         .memory_queue = 2,
                         .write_queue = 4};

constexpr int cycles = 2'000'000;

int answered(const Tally& tally) { return tally[static_cast<size_t>(Stop::none)]; }

TEST(ElementCircuit, EqualsTheEmulatorAmongRandomRecords) {
    EXPECT_GT(answered(run_in_lockstep<ElementCircuit>(1, {}, usual, cycles)), 300);
}

TEST(ElementCircuit, EqualsTheEmulatorOnLatticesWithTies) {
    const Kind lattice{.reach = 6 * 4096, .grid = 4096};
    EXPECT_GT(answered(run_in_lockstep<ElementCircuit>(2, lattice, usual, cycles)), 300);
}

TEST(ElementCircuit, EqualsTheEmulatorInPockets) {
    const Kind pocket{.reach = 60'000, .is_pocket = true};
    EXPECT_GT(answered(run_in_lockstep<ElementCircuit>(3, pocket, usual, cycles)), 300);
}

TEST(ElementCircuit, EqualsTheEmulatorWhileLinesAreRewritten) {
    const Kind rewritten{.reach = 20'000, .rewrites = true};
    const Tally tally = run_in_lockstep<ElementCircuit>(4, rewritten, usual, cycles);
    EXPECT_GT(answered(tally), 50);
    EXPECT_GT(tally[static_cast<size_t>(Stop::model_changed)], 50);
}

TEST(ElementCircuit, EqualsTheEmulatorWithFaults) {
    const Kind faulty{.reach = 100'000, .is_faulty = true};
    const Tally tally = run_in_lockstep<ElementCircuit>(5, faulty, usual, cycles);
    for (const Stop stop : {Stop::none, Stop::bad_check, Stop::model_changed, Stop::bad_address,
                            Stop::too_long, Stop::out_of_range})
        EXPECT_GT(tally[static_cast<size_t>(stop)], 10) << name_of(stop);
}

TEST(ElementCircuit, EqualsTheEmulatorWhenItIsShortOfEverything) {
    const Kind kind{.rewrites = true, .is_faulty = true};
    const Tally tally = run_in_lockstep<SmallElementCircuit>(6, kind, small, cycles);
    EXPECT_GT(answered(tally), 50);
    EXPECT_GT(tally[static_cast<size_t>(Stop::stack_overflow)], 50);
}

} // namespace
} // namespace hwsim::rtl
