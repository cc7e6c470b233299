#pragma once

#include <optional>
#include <string>

#include "app/view/model/finding_group.h"

namespace app::viewer {

struct ViewModel;

/// Goes to a block, at a fraction of its time (1: its end), and requests its view.
void go_to(ViewModel& model, size_t block, double fraction = 1.0);

/// Goes to a block at the moment of least clearance of a pair of bodies, if known, and shows that
/// pair: the one with these names, else the deciding one.
void go_to_witness(ViewModel& model, size_t block, const BodyNames& names = {});

/// Steps by a number of blocks; with a filter, counts only blocks that pass it.
void step(ViewModel& model, int blocks);
/// Goes to the next or previous block that changes the tool.
void step_tool(ViewModel& model, bool forward);
/// Steps over the blocks of a called subprogram.
void step_over(ViewModel& model, bool forward);
/// Goes to the block after the call of the current subprogram.
void step_out(ViewModel& model);

/// Goes to the next or previous problem. While the check still runs, waits for one and goes there
/// as soon as it is found. False: there is none.
bool go_to_offending(ViewModel& model, bool forward);
/// Goes to the awaited violation if the check has found it. False: there is none.
bool await_offending(ViewModel& model);

void go_to_bookmark(ViewModel& model);

/// Goes to the worst block of a stretch of findings.
void go_to_stretch(ViewModel& model, const StretchIndex& index);
/// Goes to the next or previous stretch of the list. False: there is none.
bool step_stretch(ViewModel& model, bool forward);
/// The selected stretch of the list: the last one visited if it contains the current block, else
/// the first one that does.
std::optional<StretchIndex> selected_stretch(const ViewModel& model);
/// Shows the findings or the lines in the list.
void show_findings(ViewModel& model, bool shown);

/// Shows the set-up in place of the list, with the keyboard.
void show_setup(ViewModel& model, bool shown);
/// The key of the program in the stored notes: its absolute path.
std::string notes_key(const ViewModel& model);
std::string note_at(const ViewModel& model, const StretchIndex& index);
void write_note_at(ViewModel& model, const StretchIndex& index, const std::string& text);

/// The block with the worst verdict; among equals, one with an error, then the one with the least
/// margin. There must be rows.
size_t worst_block(const ViewModel& model);

/// The first block of a line ("188") or N number ("N1880"), searched from the cursor to the end,
/// then from the beginning.
std::optional<size_t> find_line(const ViewModel& model, const std::string& text);

/// Sets or removes a breakpoint on the line of a block.
void toggle_breakpoint(ViewModel& model, size_t block);
bool has_breakpoint(const ViewModel& model, const BlockRow& row);

/// Advances playback by some seconds of wall time. True if the cursor moved.
bool play(ViewModel& model, double seconds);

/// The next higher or lower speed in the series 0.1 0.2 0.5 1 2 5 ... 100.
double next_speed(double speed, bool faster);

} // namespace app::viewer
