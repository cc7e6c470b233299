#pragma once

#include <string_view>

#include "app/viewer/block_row.h"

namespace app::viewer {

/// Which blocks the list shows: words that must all be true, as in `T3 rapid clr<1`.
///
///   clr<1 clr<=1 clr>1 clr>=1   clearance (also clearance<1)
///   T3                          the tool in the spindle
///   rapid feed arc cycle        motion
///   violation near clear undecided finding
///   anything else               is in the text of the line, or a part's or body's name
class RowFilter {
public:
    RowFilter() = default;
    explicit RowFilter(std::string_view text);

    bool empty() const { return words_.empty(); }
    bool holds(const BlockRow& row) const;

private:
    std::vector<std::string> words_; // small letters
};

} // namespace app::viewer
