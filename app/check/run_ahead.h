#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/motion/event.h"
#include "gcode/exec/interpreter.h"
#include "gcode/lower/lowering.h"

namespace core {
struct CutModel;
class CutReplay;
struct Setup;
} // namespace core

namespace app {

struct PreparedCheck;
struct RunState;

/// A block that was read ahead: what the control makes of it, and the state after it.
struct ReadBlock {
    gcode::BlockCommands block; // its texts are set when the run gets it
    std::string text, file;
    gcode::InterpreterState control; // after the block
    gcode::Lowering lowering;        // after the block
    std::vector<core::Event> events;
    size_t first_move = 0, last_move = 0; // its cuts in the window
};

/// Reads the blocks of a program ahead of a run, and cuts a copy of the stock along them, on other
/// threads. The run takes the blocks one by one and repeats the cuts, which costs it much less than
/// reading and cutting; its results are the same bits.
///
/// It foresees only what follows from reading. Where a block does not go as foreseen, the run goes
/// on by itself: at a rapid that runs into the stock, an alarm, a probing move, the end.
///
/// Threads: while it exists, nobody else may use the program's library. All functions are for the
///          thread of the run.
class RunAhead {
public:
    /// Starts up to `threads` - 1 threads.
    ///
    /// Cost:   some 50 ns for each tile of the stock.
    RunAhead(const PreparedCheck& check, const core::Setup& setup, const RunState& from,
             unsigned threads);
    ~RunAhead();
    RunAhead(const RunAhead&) = delete;
    RunAhead& operator=(const RunAhead&) = delete;

    /// The next block, valid until the next call; null if the run must read on by itself. `model`
    /// is the run's stock, which has made all cuts so far. Works on the cuts while waiting for
    /// them.
    ReadBlock* next(const core::CutModel& model);

    /// Makes the cuts of that block in `model`, for BlockEvents::replay.
    core::CutReplay& cuts(const core::CutModel& model);
    /// Whether the block has made exactly the cuts that were foreseen. If not, this is over.
    bool went_as_foreseen() const;

    /// Ends the reading and all threads. The current block remains valid.
    void halt();

private:
    struct EarlierAccess;
    struct Window;
    class Reader;
    class Team;

    std::unique_ptr<Team> team_;
};

} // namespace app
