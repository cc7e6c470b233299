#pragma once

#include <bit>

#include "core/dbm/cut_model.h"

namespace test_support {

/// A hash of a model's lines, columns and marks.
inline uint64_t digest(const core::CutModel& model) {
    uint64_t hash = 1469598103934665603ULL;
    const auto add = [&](uint64_t value) { hash = (hash ^ value) * 1099511628211ULL; };
    const auto add_family = [&](const core::ScanLines& lines) {
        for (int v = 0; v < lines.v_count(); ++v)
            for (int u = 0; u < lines.u_count(); ++u) {
                const core::LineView line = lines.line(u, v);
                add(line.size());
                for (size_t i = 0; i < line.size(); ++i) {
                    add(std::bit_cast<uint64_t>(line[i].lower));
                    add(std::bit_cast<uint64_t>(line[i].upper));
                    const core::EndMarks marks = lines.marks(u, v, i);
                    add(marks.lower);
                    add(marks.upper);
                }
            }
    };
    for (const core::ScanLines& family : model.lines.families) add_family(family);
    add_family(model.columns);
    return hash;
}

} // namespace test_support
