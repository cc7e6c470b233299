#pragma once

#include <optional>
#include <string>

#include "app/view/model/finding_group.h"

namespace app::viewer {

struct ViewModel;

/// Goes to a block. `share` 1 is its end; the view that belongs to it is asked for.
void go_to(ViewModel& model, size_t block, double share = 1.0);

/// Goes to a block at the moment at which it comes nearest, if that is known.
void go_to_witness(ViewModel& model, size_t block);

/// Steps by so many blocks; with a filter, by blocks that it lets through.
void step(ViewModel& model, int blocks);
/// To the next or previous block that changes the tool.
void step_tool(ViewModel& model, bool forward);
/// Past the blocks that a call makes.
void step_over(ViewModel& model, bool forward);
/// Behind the call of the subprogram that the cursor is in.
void step_out(ViewModel& model);

/// To the next or previous violation. Whether there is one that is known, or may still be found: if
/// the check still runs, the model goes there as soon as one is.
bool go_to_offending(ViewModel& model, bool forward);
/// Goes to the violation that is awaited, if it is known by now. False: there is none.
bool await_offending(ViewModel& model);

void go_to_bookmark(ViewModel& model);

/// To the worst block of a stretch of findings.
void go_to_stretch(ViewModel& model, const StretchPlace& place);
/// To the stretch behind or before the one selected, as the list has them; whether there is one.
bool step_stretch(ViewModel& model, bool forward);
/// The stretch that the list marks: the one gone to, else the first one that holds the block.
std::optional<StretchPlace> selected_stretch(const ViewModel& model);
/// Shows the findings in place of the lines, or the lines again.
void show_findings(ViewModel& model, bool shown);
/// By what notes know the program: its path from the root.
std::string notes_key(const ViewModel& model);
std::string note_at(const ViewModel& model, const StretchPlace& place);
void write_note_at(ViewModel& model, const StretchPlace& place, const std::string& text);

/// The block with the worst verdict, among equals one with an error, then the least margin. There
/// must be rows.
size_t worst_block(const ViewModel& model);

/// The first block of a line ("188") or N number ("N1880") from the cursor on, then from the
/// beginning.
std::optional<size_t> find_line(const ViewModel& model, const std::string& text);

/// Sets a breakpoint on the line of a block, or takes it away.
void toggle_breakpoint(ViewModel& model, size_t block);
bool has_breakpoint(const ViewModel& model, const BlockRow& row);

/// Plays on by so many seconds of wall time. Whether the cursor has moved.
bool play(ViewModel& model, double seconds);

/// The speed after the next or before the last of 0.1 0.2 0.5 1 2 5 ... 100.
double next_speed(double speed, bool faster);

} // namespace app::viewer
