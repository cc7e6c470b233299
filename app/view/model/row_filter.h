#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/debug/condition.h"
#include "app/view/model/block_row.h"

namespace app::viewer {

/// Selects the blocks that the list shows: those that meet a condition, as in breakpoints
/// (`clearance < 1 and rapid`, `T3`, `rule = near-miss`), or those whose line contains a text
/// (`G81`).
///
/// Input that is not a condition, and has no operators or keywords of one, is searched for as text.
class RowFilter {
public:
    RowFilter() = default;
    explicit RowFilter(const std::string& text);

    /// Whether all rows pass because the filter is empty or invalid.
    bool empty() const { return !condition_ && wanted_.empty(); }
    /// The error of the condition; empty: none.
    const std::string& refusal() const { return refusal_; }
    /// The text that lines must contain; empty for a condition.
    const std::string& wanted_text() const { return wanted_; }

    /// The rows that pass, in order. `findings`: those of all rows.
    std::vector<size_t> passed(const std::vector<BlockRow>& rows,
                               const std::vector<core::Finding>& findings) const;

private:
    std::optional<Condition> condition_;
    std::string wanted_; // in lower case
    std::string refusal_;
};

} // namespace app::viewer
