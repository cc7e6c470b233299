#pragma once

#include <array>
#include <string>
#include <vector>

#include "app/view/model/block_row.h"

namespace app::viewer {

/// Findings of one rule about one pair in successive blocks; blocks without motion in between do
/// not end the stretch.
struct FindingStretch {
    size_t first = 0, last = 0;           // blocks
    size_t count = 0;                     // blocks that have the finding
    size_t worst = 0;                     // the block with the largest shortfall
    std::optional<double> clearance;      // in the worst block, mm; empty: not about a clearance
    double shortfall = 0.0;               // in the worst block, mm
    std::optional<core::Overlap> overlap; // in the worst block, if its depth was measured
    std::string message, cure;            // of the finding in the worst block
};

/// All findings of one rule about one pair of bodies or, if they are about none, with one message.
struct FindingGroup {
    std::string rule;
    std::array<std::string, 2> pair; // empty if the rule is not about a pair
    core::Severity severity = core::Severity::off;
    std::vector<FindingStretch> stretches; // in program order; empty if about the whole program
    size_t worst = 0;                      // index of the worst stretch
    size_t count = 0;                      // blocks
    std::string message, cure;             // if about the whole program
};

/// Depth of the overlap in the worst block, mm: an upper bound, or the lower bound if there is
/// none; empty if it was not measured.
std::optional<double> depth_of(const FindingStretch& stretch);

/// The findings of a program in groups, sorted by severity, then by shortfall, then by block.
std::vector<FindingGroup> grouped(const std::vector<BlockRow>& rows,
                                  const std::vector<core::Finding>& findings);

/// The indices of a group and of a stretch in it.
struct StretchIndex {
    size_t group = 0, stretch = 0;

    bool operator==(const StretchIndex&) const = default;
};

/// The first stretch that contains a block.
std::optional<StretchIndex> stretch_at(const std::vector<FindingGroup>& groups, size_t block);

/// The next or previous stretch of the list; without `from`, the first or last one. Empty at the
/// end of the list.
std::optional<StretchIndex> neighbouring_stretch(const std::vector<FindingGroup>& groups,
                                                 const std::optional<StretchIndex>& from,
                                                 bool forward);

/// A note of the user on a stretch of findings. It is matched by rule, bodies and the text of the
/// first line, so it survives inserted lines.
struct FindingNote {
    std::string program; // path of the file
    std::string rule;
    std::array<std::string, 2> pair;
    std::string file; // of the subprogram; empty: main program
    uint32_t line = 0;
    std::string code; // text of that line
    std::string text;

    bool operator==(const FindingNote&) const = default;
};

/// The note on a stretch; if several lines have the same text, that of the nearest line. Empty: no
/// note.
std::string note_on(const std::vector<FindingNote>& notes, const std::string& program,
                    const FindingGroup& group, const BlockRow& first);

/// Sets the note on a stretch; an empty text removes it.
void write_note(std::vector<FindingNote>& notes, const std::string& program,
                const FindingGroup& group, const BlockRow& first, const std::string& text);

/// Parses notes; skips invalid entries.
std::vector<FindingNote> notes_in(const std::string& text);

std::string text_of(const std::vector<FindingNote>& notes);

/// Stored notes with those of one program replaced, so that two windows do not overwrite each
/// other.
std::vector<FindingNote> merged(std::vector<FindingNote> stored,
                                const std::vector<FindingNote>& notes, const std::string& program);

} // namespace app::viewer
