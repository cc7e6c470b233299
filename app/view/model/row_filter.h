#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/debug/condition.h"
#include "app/view/model/block_row.h"

namespace app::viewer {

/// Which blocks the list shows: those of which a condition is true, as breakpoints have it
/// (`clearance < 1 and rapid`, `T3`, `rule = near-miss`), or those whose line has a text (`G81`).
///
/// What cannot be read as a condition, and has none of its signs and words, is such a text.
class RowFilter {
public:
    RowFilter() = default;
    explicit RowFilter(const std::string& text);

    /// Whether it lets all rows through, because nothing was written or it was refused.
    bool empty() const { return !condition_ && wanted_.empty(); }
    /// What is wrong with the condition, or cannot be asked of rows; empty if nothing is.
    const std::string& refusal() const { return refusal_; }
    /// The text that lines must have; empty for a condition.
    const std::string& wanted_text() const { return wanted_; }

    /// The rows that it lets through, in order. `findings` are those about all rows.
    std::vector<size_t> passed(const std::vector<BlockRow>& rows,
                               const std::vector<core::Finding>& findings) const;

private:
    std::optional<Condition> condition_;
    std::string wanted_; // in small letters
    std::string refusal_;
};

} // namespace app::viewer
