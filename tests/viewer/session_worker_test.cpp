#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <future>

#include <gtest/gtest.h>

#include "app/check/check_job.h"
#include "app/check/check_run.h"
#include "app/check/setup_sheet.h"
#include "app/view/model/axis_display.h"
#include "app/view/model/navigation.h"
#include "app/view/model/open_programs.h"
#include "app/view/model/scene_of.h"
#include "app/view/model/session_worker.h"
#include "app/view/model/view_model.h"
#include "app/view/ui/command.h"
#include "tests/support/scoped_folder.h"

namespace {

using namespace app::viewer;

const std::string assets = FEELER_SOURCE_DIR "/assets/";

app::CheckJob clamped_plate() {
    app::CheckJob job;
    job.program = assets + "programs/clamped_plate_low.nc";
    job.setup = assets + "setups/clamped_plate.toml";
    return job;
}

/// What a window would know, without one. After each update the worker waits until it was taken in,
/// so that a slow test sees all steps of a check.
class Watcher {
public:
    ViewModel model;

    ~Watcher() {
        {
            const std::lock_guard lock(mutex_);
            is_ending_ = true;
        }
        woken_.notify_all();
    }

    void open(const app::CheckJob& job) { model.reading = worker_.open(job); }
    SessionWorker& worker() { return worker_; }

    /// Takes in news until something is true; whether it came to be.
    template <typename Condition>
    bool wait_for(const Condition& condition) {
        // clock: gives up after 3 min
        const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(3);
        while (true) {
            take_in(model, worker_.take(), 0.0);
            if (condition()) return true;
            std::unique_lock lock(mutex_);
            // clock: as above
            if (!woken_.wait_until(lock, end, [&] { return is_woken_; })) return false;
            is_woken_ = false;
            woken_.notify_all();
        }
    }
    bool record() {
        return wait_for([&] { return model.is_recorded || model.failure; }) && !model.failure;
    }

private:
    std::mutex mutex_;
    std::condition_variable woken_;
    bool is_woken_ = false, is_ending_ = false;
    SessionWorker worker_{[this] {
        std::unique_lock lock(mutex_);
        is_woken_ = true;
        woken_.notify_all();
        woken_.wait(lock, [this] { return !is_woken_ || is_ending_; });
    }};
};

/// Goes to the end of the first block of a line. Returns whether it can be seen.
bool go_after(Watcher& watcher, const std::string& line) {
    const auto block = find_line(watcher.model, line);
    if (!block) return false;
    watcher.model.cursor = {*block, 1.0};
    watcher.worker().show({*block, true});
    return watcher.wait_for([&] {
        const auto& state = watcher.model.block_state;
        return state && state->block == *block && state->at_end;
    });
}

/// The arrows at the zero of the program after the first block of a line.
std::optional<render::Triad> zero_after(Watcher& watcher, const std::string& line) {
    return go_after(watcher, line) ? program_triad(watcher.model) : std::nullopt;
}

/// The program on a trunnion with tilted planes and tool centre point control.
app::CheckJob tilted_faces() {
    app::CheckJob job;
    job.program = assets + "programs/tilted_faces.nc";
    job.setup = assets + "setups/tilted_faces.toml";
    return job;
}

TEST(SessionWorker, ShowsNothingOldAsCurrent) {
    const test_support::ScopedFolder folder;
    Watcher watcher;
    const auto show = [&](const std::string& program, const std::string& setup) {
        app::CheckJob job;
        job.program = folder.write("p.nc", program);
        job.setup_text = setup;
        watcher.model.workspace.document = app::SetupDocument("", setup);
        watcher.open(job);
    };
    const std::string program = "G21 G90\nT1 M6\nM3 S3000\nG0 X0 Y0 Z9.\nG1 Z-2. F300.\nG0 Z9.\n";
    const std::string setup = "[stock]\nbox = [[-10, -10, -10], [10, 10, 0]]\n";
    show(program, setup);
    EXPECT_FALSE(is_current(watcher.model));
    ASSERT_TRUE(watcher.record());
    EXPECT_TRUE(is_current(watcher.model));
    // The same text again, because another file has changed; only the last request counts.
    show(program, setup);
    show(program, setup);
    EXPECT_FALSE(is_current(watcher.model));
    EXPECT_TRUE(watcher.model.program) << "the old state is shown meanwhile";
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.reading == 0; }));
    ASSERT_TRUE(watcher.record());
    EXPECT_TRUE(is_current(watcher.model));
    EXPECT_EQ(tab_titles({&watcher.model})[0].state, render::ClearanceState::clear);
    // What cannot be read is not current either.
    show(program, "[stock]\nmesh = \"none.stl\"\n");
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.reading == 0; }));
    EXPECT_TRUE(watcher.model.workspace.error);
    EXPECT_FALSE(is_current(watcher.model));
    EXPECT_EQ(tab_titles({&watcher.model})[0].state, render::ClearanceState::none);
}

TEST(SessionWorker, KnowsWhereTheZeroOfTheProgramIs) {
    Watcher watcher;
    watcher.open(clamped_plate());
    ASSERT_TRUE(watcher.record());
    const auto triad = zero_after(watcher, "44"); // the stock is given in coordinates of G54
    ASSERT_TRUE(triad);
    EXPECT_EQ(triad->name, "G54");
    EXPECT_LT(glm::length(triad->origin), 1e-9);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(triad->axes[axis][axis], 1.0, 1e-9);
    const render::Scene scene = scene_of(watcher.model);
    ASSERT_EQ(scene.triads.size(), 2u);
    EXPECT_EQ(scene.triads[1].name, "machine zero");
    EXPECT_LT(glm::distance(scene.triads[1].origin, core::Vec3(470, 300, 592)), 1e-9);
    ASSERT_TRUE(scene.ground); // the top of the table
    EXPECT_NEAR(scene.ground->scene_from_ground.translation.z, -620.0 + 592.0, 1e-4);
}

TEST(SessionWorker, FollowsTheZeroIntoATiltedPlane) {
    Watcher watcher;
    watcher.open(tilted_faces());
    ASSERT_TRUE(watcher.record());
    const auto triad = zero_after(watcher, "84"); // after G68.2 X-40. Y0 Z-20. I270. J90.
    ASSERT_TRUE(triad);
    EXPECT_LT(glm::distance(triad->origin, core::Vec3(-40, 0, -20)), 1e-6);
    EXPECT_LT(glm::distance(triad->axes[2], core::Vec3(-1, 0, 0)), 1e-6); // out of the left face
}

/// The coordinates of the program on the axis display: X, Y, Z.
core::Vec3 program_position(const ViewModel& model) {
    const auto rows = axis_rows(model);
    core::Vec3 position(core::infinity);
    for (size_t i = 0; i < std::min<size_t>(rows.size(), 3); ++i)
        position[static_cast<int>(i)] = rows[i].program.value_or(core::infinity);
    return position;
}

TEST(AxisDisplay, ShowsThePositionThatTheProgramStates) {
    Watcher watcher;
    watcher.open(tilted_faces());
    ASSERT_TRUE(watcher.record());
    struct Stated {
        const char* line;
        core::Vec3 position;
        double a, c;
    };
    // In planes tilted by 45 degrees, the second turned by 90; with the tip kept on a ring.
    const Stated all[] = {{"15", {-60, 0, -4.243}, -45, 0},
                          {"26", {60, 0, -4.243}, -45, -90},
                          {"98", {23.201, 2.03, -2.698}, -20, -85},
                          {"115", {0, 23.29, -2.698}, -20, 0}};
    for (const Stated& stated : all) {
        ASSERT_TRUE(go_after(watcher, stated.line));
        EXPECT_LT(glm::distance(program_position(watcher.model), stated.position), 1e-6)
            << stated.line;
        const auto rows = axis_rows(watcher.model);
        ASSERT_EQ(rows.size(), 5u);
        EXPECT_NEAR(std::abs(rows[3].machine), -stated.a, 1e-6) << stated.line;
        EXPECT_NEAR(std::remainder(rows[4].machine - stated.c, 180.0), 0.0, 1e-6) << stated.line;
        EXPECT_NEAR(*rows[3].below, rows[3].machine + 110.0, 1e-9);
        EXPECT_NEAR(*rows[3].above, 30.0 - rows[3].machine, 1e-9);
        EXPECT_FALSE(rows[4].below || rows[4].above) << "C turns endlessly";
    }
    const auto rows = axis_rows(watcher.model);
    EXPECT_TRUE(rows[4].moves);
    EXPECT_FALSE(rows[3].moves);
}

TEST(AxisDisplay, MovesAxesByHandWithoutChangingTheProgram) {
    Watcher watcher;
    watcher.open(tilted_faces());
    ASSERT_TRUE(watcher.record());
    ASSERT_TRUE(go_after(watcher, "15"));
    ViewModel& model = watcher.model;
    const auto planned = axis_rows(model);
    const auto cradle = [&] {
        const render::Scene scene = scene_of(model);
        const auto found =
            std::find_if(scene.bodies.begin(), scene.bodies.end(),
                         [](const auto& body) { return body.name == "bearing-left"; });
        return found->stock_from_body;
    };
    const auto key = key_of(model, {});
    const core::Transform before = cradle();
    EXPECT_TRUE(witness_of(model));
    jog(model, 3, 0.0);
    EXPECT_TRUE(is_jogged(model));
    EXPECT_FALSE(key_of(model, {}) == key) << "a new picture is drawn";
    EXPECT_FALSE(witness_of(model)) << "it belongs to another position";
    EXPECT_NE(cradle().rotation, before.rotation) << "the bearings stand, the work turns";
    EXPECT_EQ(axis_rows(model)[3].machine, 0.0);
    EXPECT_TRUE(axis_rows(model)[3].moves);
    EXPECT_FALSE(axis_rows(model)[0].moves);
    EXPECT_NE(axis_rows(model)[1].program, planned[1].program) << "the plane has turned away";
    jog(model, 0, 1e4);
    EXPECT_EQ(axis_rows(model)[0].machine, 300.0) << "as far as the axis goes";
    jog(model, 5, 1e4);
    EXPECT_EQ(axis_rows(model)[4].machine, 1e4);
    perform(model, Command::close_popup, 0.0);
    EXPECT_FALSE(is_jogged(model));
    EXPECT_EQ(cradle().rotation, before.rotation);
    jog(model, 3, 0.0);
    const Cursor here = model.cursor;
    go_to(model, here.block + 1, 1.0);
    EXPECT_FALSE(is_jogged(model));
    go_to(model, here.block, here.fraction);
    EXPECT_FALSE(is_jogged(model)) << "another block has put the axes back";
    EXPECT_NE(axis_rows(model)[3].machine, 0.0);
}

TEST(AxisDisplay, ShowsTheToolWhereTheTableTurns) {
    Watcher watcher;
    watcher.open(tilted_faces());
    ASSERT_TRUE(watcher.record());
    ASSERT_TRUE(go_after(watcher, "15")); // the tool is across the chamfer at Y-40
    const render::Scene scene = scene_of(watcher.model);
    const auto tool = std::find_if(scene.triads.begin(), scene.triads.end(),
                                   [](const auto& triad) { return triad.name == "tool"; });
    ASSERT_NE(tool, scene.triads.end());
    const double half = std::sqrt(0.5);
    EXPECT_LT(glm::distance(tool->axes[2], core::Vec3(0, -half, half)), 1e-9);
    EXPECT_LT(glm::distance(tool->origin, *tip_now(watcher.model)), 1e-12);
}

TEST(SessionWorker, PublishesTheResultOfACheck) {
    Watcher watcher;
    watcher.open(clamped_plate());
    ASSERT_TRUE(watcher.record());
    const auto run = app::run_check(clamped_plate());
    ASSERT_TRUE(run.has_value());
    const ViewModel& model = watcher.model;
    ASSERT_EQ(model.rows.size(), run->blocks.size());
    for (size_t i = 0; i < model.rows.size(); ++i) {
        const BlockRow expected = row_of(run->setup, run->blocks[i]);
        EXPECT_EQ(model.rows[i].line, expected.line) << i;
        EXPECT_EQ(model.rows[i].text, expected.text) << i;
        EXPECT_EQ(model.rows[i].verdict, expected.verdict) << i;
        EXPECT_EQ(model.rows[i].lower, expected.lower) << i;
        EXPECT_EQ(model.rows[i].upper, expected.upper) << i;
        EXPECT_EQ(model.rows[i].duration, expected.duration) << i;
        EXPECT_EQ(model.rows[i].time, expected.time) << i;
    }
    EXPECT_EQ(model.findings.size(), run->findings.size());
    EXPECT_FALSE(model.offending.empty());
    ASSERT_TRUE(model.path);
    for (const uint32_t block : {15U, 39U})
        EXPECT_FALSE(render::bounds_of_block(*model.path, block).empty()) << block;
}

/// The program beginning above the machine's travel: errors that no clearance tells of.
app::CheckJob out_of_travel(const test_support::ScopedFolder& folder) {
    std::string text = test_support::bytes_of(assets + "programs/clamped_plate.nc");
    text.replace(text.find("G53 G0 Z0"), 9, "G53 G0 Z40");
    app::CheckJob job = clamped_plate();
    job.program = folder.write("high.nc", text);
    return job;
}

/// How the pieces of a block's path are coloured, if all are the same.
std::optional<render::ClearanceState> colour_of(const render::ToolPath& path, size_t block) {
    const auto [first, last] = render::points_of_block(path, static_cast<uint32_t>(block));
    if (first == last) return {};
    for (size_t i = first; i < last; ++i)
        if (path.points[i].state != path.points[first].state) return {};
    return path.points[first].state;
}

TEST(SessionWorker, PathAndListShowABlockWithAnErrorAlike) {
    const test_support::ScopedFolder folder;
    Watcher watcher;
    watcher.open(out_of_travel(folder));
    ASSERT_TRUE(watcher.record());
    const ViewModel& model = watcher.model;
    size_t by_finding = 0, shown = 0;
    for (size_t i = 0; i < model.rows.size(); ++i) {
        if (is_offending(model.rows[i]) && model.rows[i].verdict == core::Verdict::clear)
            ++by_finding;
        const auto colour = colour_of(*model.path, i);
        if (!colour) continue;
        ++shown;
        EXPECT_EQ(*colour, state_of(model.rows[i])) << i << ": " << model.rows[i].text;
    }
    EXPECT_GT(by_finding, 0U);
    EXPECT_GT(shown, 30U);
}

TEST(SessionWorker, ShowsABlockAsItFindsTheStockAndAsItLeavesIt) {
    Watcher watcher;
    watcher.open(clamped_plate());
    ASSERT_TRUE(watcher.record());
    const auto show = [&](size_t block, bool at_end) {
        watcher.worker().show({block, at_end});
        return watcher.wait_for([&] {
            const auto& block_state = watcher.model.block_state;
            return block_state && block_state->block == block && block_state->at_end == at_end;
        });
    };
    ASSERT_TRUE(show(15, false));
    const auto before = watcher.model.block_state;
    ASSERT_TRUE(show(15, true));
    const auto after = watcher.model.block_state;
    EXPECT_FALSE(before->stock.empty());
    EXPECT_NE(before->stock, after->stock) << "this block cuts";
    ASSERT_FALSE(after->poses.empty());
    EXPECT_EQ(pose_at(after->poses, 1.0), after->standing);
    ASSERT_TRUE(show(15, false));
    ASSERT_EQ(watcher.model.block_state->stock.size(), before->stock.size());
}

TEST(SessionWorker, StopsAtABreakpoint) {
    Watcher watcher;
    watcher.open(clamped_plate());
    ASSERT_TRUE(watcher.record());
    app::Breakpoint breakpoint;
    breakpoint.line = 44;
    watcher.worker().set_breakpoints({breakpoint});
    watcher.model.walk = Walk::go_on;
    send_requests(watcher.model, watcher.worker());
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.cursor.block > 0; }));
    EXPECT_EQ(watcher.model.row().line, 44U);
    EXPECT_EQ(watcher.model.cursor.fraction, 0.0);
    ASSERT_EQ(watcher.model.breakpoints.size(), 1U);
    EXPECT_EQ(watcher.model.breakpoints[0].hits, 1U);
}

TEST(SessionWorker, PublishesFindingsDuringALongWalk) {
    Watcher watcher;
    app::CheckJob job = clamped_plate();
    job.program = assets + "programs/PARALLEL.NC";
    job.setup = assets + "setups/parallel.toml";
    watcher.open(job);
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.has_rows(); }));
    watcher.model.walk = Walk::go_on; // there is no breakpoint: it goes to the end
    send_requests(watcher.model, watcher.worker());
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.rows[100].is_known; }));
    EXPECT_TRUE(watcher.model.walking);
    watcher.worker().show({50, true});
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.block_state != nullptr; }));
    EXPECT_TRUE(watcher.model.walking) << "a block is shown on the way";
    ASSERT_TRUE(watcher.wait_for([&] { return !watcher.model.walking; }));
    EXPECT_EQ(watcher.model.cursor.block, watcher.model.rows.size() - 1);
}

TEST(SessionWorker, AWhatIfChangesOnlyWhatComesAfterIt) {
    Watcher watcher;
    watcher.open(clamped_plate());
    ASSERT_TRUE(watcher.record());
    const auto before = watcher.model.rows;
    const size_t violations = watcher.model.offending.size();
    watcher.worker().change(app::MovedFixture{"strap-1", {0.0, 0.0, -60.0}}, 30);
    ASSERT_TRUE(watcher.wait_for([&] { return !watcher.model.changes.empty(); }));
    ASSERT_TRUE(watcher.record());
    ASSERT_EQ(watcher.model.rows.size(), before.size());
    for (size_t i = 0; i < 30; ++i) EXPECT_EQ(watcher.model.rows[i].lower, before[i].lower) << i;
    EXPECT_LT(watcher.model.offending.size(), violations);
    watcher.worker().take_back();
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.changes.empty(); }));
    ASSERT_TRUE(watcher.record());
    EXPECT_EQ(watcher.model.offending.size(), violations);
}

TEST(SessionWorker, SaysWhyAProgramCannotBeOpened) {
    Watcher watcher;
    app::CheckJob job = clamped_plate();
    job.program = assets + "meshes/clamp.stl";
    watcher.open(job);
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.failure.has_value(); }));
    EXPECT_NE(watcher.model.failure->message, "");
    watcher.open(clamped_plate());
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.is_recorded; }))
        << "the next one opens as usual";
}

/// The next end of a walk that a worker tells of.
std::optional<RunEnd> next_end(SessionWorker& worker) {
    for (int tries = 0; tries < 6000; ++tries) {
        SessionUpdate news = worker.take();
        if (news.walk) return news.walk;
        std::this_thread::sleep_for(std::chrono::milliseconds(10)); // clock: gives up after 1 min
    }
    return {};
}

TEST(SessionWorker, AWalkThatIsInterruptedBeforeItBeginsGoesNowhere) {
    std::promise<void> interrupted;
    SessionWorker worker([end = interrupted.get_future().share()] { end.wait(); });
    worker.open(clamped_plate());
    const uint64_t first = worker.walk(Walk::go_on, 0); // it waits for the program
    worker.interrupt();
    interrupted.set_value();
    const auto ended = next_end(worker);
    ASSERT_TRUE(ended);
    EXPECT_EQ(ended->walk, first);
    EXPECT_EQ(ended->stop.reason, app::StopReason::interrupted);
    EXPECT_LE(ended->block, 1U);
    const uint64_t second = worker.walk(Walk::go_on, 0);
    const auto other = next_end(worker);
    ASSERT_TRUE(other);
    EXPECT_EQ(other->walk, second);
    EXPECT_EQ(other->stop.reason, app::StopReason::end);
}

TEST(SessionWorker, TheEndOfAnAbandonedWalkChangesNothing) {
    Watcher watcher;
    watcher.open(clamped_plate());
    ASSERT_TRUE(watcher.record());
    go_to(watcher.model, 3);
    watcher.model.walk = Walk::go_on;
    send_requests(watcher.model, watcher.worker());
    ASSERT_TRUE(watcher.model.walking);
    go_to(watcher.model, 7);
    EXPECT_TRUE(watcher.model.wants_interrupt);
    send_requests(watcher.model, watcher.worker());
    ASSERT_TRUE(watcher.wait_for(
        [&] { return watcher.model.block_state && watcher.model.block_state->block == 7; }));
    EXPECT_EQ(watcher.model.cursor.block, 7U);
}

TEST(SessionWorker, EndsAtAnyMoment) {
    for (int milliseconds = 0; milliseconds < 200; milliseconds += 9) {
        std::atomic<int> news = 0;
        SessionWorker worker([&] { ++news; });
        worker.open(clamped_plate());
        worker.show({3, true});
        worker.walk(Walk::go_on, 0);
        // clock: any moment
        std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
        worker.show({20, false});
    }
}

/// A program that cuts a slot, without a set-up.
app::CheckJob slot(const test_support::ScopedFolder& folder) {
    app::CheckJob job;
    job.program = folder.write("p.nc", "G21 G90 G54\nT1 M6\nS8000 M3\nG43 H1 Z5\nG0 X0 Y0\n"
                                       "G1 Z-3 F200\nX40\nG0 Z5\nM30\n");
    return job;
}

TEST(SessionWorker, ChecksAgainWithAnEditedSetup) {
    const test_support::ScopedFolder folder;
    app::CheckJob job = slot(folder);
    Watcher watcher;
    watcher.open(job);
    ASSERT_TRUE(watcher.record());
    ASSERT_EQ(watcher.model.program->sheet->tools.size(), 1u);
    go_to(watcher.model, 4);
    watcher.model.bookmarks = {3};
    watcher.worker().show({4, true});
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.block_state != nullptr; }));

    job.setup_text = "[[tool]]\nnumber = 1\ndiameter = 12\n";
    watcher.open(job);
    bool was_blank = false, was_outdated = false;
    ASSERT_TRUE(watcher.wait_for([&] {
        const ViewModel& model = watcher.model;
        was_blank = was_blank || !model.program || !model.has_rows() || !model.block_state;
        was_outdated = was_outdated || (model.opening == 2 && model.block_state->is_outdated);
        return model.opening == 2 && model.is_recorded;
    }));
    EXPECT_FALSE(was_blank) << "the program stays on screen";
    EXPECT_TRUE(was_outdated) << "with the stock of the set-up before";
    watcher.worker().show({4, true});
    EXPECT_TRUE(watcher.wait_for([&] { return !watcher.model.block_state->is_outdated; }));
    EXPECT_EQ(watcher.model.cursor.block, 4u);
    EXPECT_EQ(watcher.model.bookmarks, (std::set<size_t>{3}));
    const app::SetupSheet& edited = *watcher.model.program->sheet;
    EXPECT_EQ(edited.tools[0].source_of("diameter"), app::SetupSource::stated);
    EXPECT_EQ(edited.tools[0].tool.diameter, 12.0);
}

TEST(SessionWorker, KeepsTheLastGoodStateIfTheSetupCannotBeRead) {
    const test_support::ScopedFolder folder;
    app::CheckJob job = slot(folder);
    Watcher watcher;
    watcher.open(job);
    ASSERT_TRUE(watcher.record());
    job.setup_text = "[[tool]]\nnumber = 1\ndiametre = 12\n";
    watcher.open(job);
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.workspace.error.has_value(); }));
    EXPECT_EQ(watcher.model.workspace.error->where.line, 3u);
    EXPECT_EQ(watcher.model.opening, 1u);
    EXPECT_TRUE(watcher.model.has_rows() && watcher.model.is_recorded && !watcher.model.failure);
    watcher.worker().show({6, true});
    EXPECT_TRUE(watcher.wait_for(
        [&] { return watcher.model.block_state && watcher.model.block_state->block == 6; }));
    job.setup_text = "[[tool]]\nnumber = 1\ndiameter = 12\n";
    watcher.open(job);
    ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.opening == 2; }));
    EXPECT_FALSE(watcher.model.workspace.error);
}

TEST(SessionWorker, KeepsTheLastGoodStateIfTheProgramCannotBeRead) {
    const test_support::ScopedFolder folder;
    const app::CheckJob job = slot(folder);
    const std::string good = test_support::bytes_of(job.program);
    Watcher watcher;
    watcher.open(job);
    ASSERT_TRUE(watcher.record());
    const size_t rows = watcher.model.rows.size();
    uint64_t opening = 1;
    for (const std::string& bad : {std::string("GARBAGE[[["), std::string("%\n(only words)\n"),
                                   std::string("G0 X0\n\0\0\0", 9), std::string()}) {
        std::ofstream(job.program, std::ios::binary) << bad;
        watcher.open(job);
        ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.workspace.error.has_value(); }));
        EXPECT_EQ(watcher.model.workspace.error->file, job.program);
        EXPECT_NE(last_good_words(watcher.model), "");
        EXPECT_NE(window_title(watcher.model).find(", last good state"), std::string::npos);
        EXPECT_EQ(watcher.model.opening, opening);
        EXPECT_EQ(watcher.model.rows.size(), rows);
        EXPECT_FALSE(watcher.model.failure || watcher.model.stopped);
        std::ofstream(job.program, std::ios::binary) << good;
        watcher.open(job);
        ASSERT_TRUE(watcher.wait_for([&] { return watcher.model.opening == opening + 1; }));
        EXPECT_FALSE(watcher.model.workspace.error);
        EXPECT_EQ(last_good_words(watcher.model), "");
        ++opening;
    }
}

TEST(SessionWorker, ReadsOnlyTheLastOfManyEdits) {
    const test_support::ScopedFolder folder;
    app::CheckJob job = slot(folder);
    Watcher watcher;
    watcher.open(job);
    ASSERT_TRUE(watcher.record());
    for (int diameter = 1; diameter <= 40; ++diameter) {
        job.setup_text = "[[tool]]\nnumber = 1\ndiameter = " + std::to_string(diameter) + "\n";
        watcher.open(job);
    }
    ASSERT_TRUE(watcher.wait_for([&] {
        return watcher.model.program && watcher.model.program->sheet->tools[0].tool.diameter == 40.0
               && watcher.model.is_recorded;
    }));
    EXPECT_LT(watcher.model.opening, 41u) << "edits that came too fast are left out";
}

} // namespace
