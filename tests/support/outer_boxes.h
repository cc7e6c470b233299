#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/distance/outer_model.h"
#include "core/distance/rounding.h"

namespace test_support {

using core::Aabb;
using core::cell_of;
using core::Interval;
using core::LineView;
using core::OuterModel;
using core::ScanLines;
using core::u_axis;
using core::v_axis;

/// The cells across `axis` that an interval along it overlaps, first .. last.
struct CellRange {
    int first, last;
};

inline CellRange cells_met(const OuterModel& model, int axis, const Interval& stretch) {
    const double first_line = model.grid.coordinate(axis, 0);
    const auto near = [&](double x) {
        return static_cast<int>(std::clamp(std::floor((x - first_line) / model.grid.spacing), -1.0,
                                           model.grid.count(axis) - 1.0))
               + 1;
    };
    // One more on either side: the estimate is rounded, and cells without overlap drop out.
    return {std::max(0, near(stretch.lower) - 1),
            std::min(model.grid.count(axis), near(stretch.upper) + 1)};
}

/// The parts of a list within a cell, both closed; a part may be a single point.
inline void clip(const LineView& list, const Interval& cell, std::vector<Interval>& parts) {
    parts.clear();
    for (const Interval& i : list) {
        const Interval part{std::max(i.lower, cell.lower), std::min(i.upper, cell.upper)};
        if (part.lower <= part.upper) parts.push_back(part);
    }
}

/// Builds the boxes of a model, column by column of its first family.
class BoxBuilder {
public:
    explicit BoxBuilder(const OuterModel& model)
        : model_(model),
          along_(model.families.front().axis()),
          u_(u_axis(along_)),
          v_(v_axis(along_)) {
        for (const ScanLines& family : model.families)
            families_[static_cast<size_t>(family.axis())] = &family;
    }

    std::vector<Aabb> run() {
        const ScanLines& columns = model_.families.front();
        for (int j = 0; j < columns.v_count(); ++j)
            for (int i = 0; i < columns.u_count(); ++i) {
                first_of_column_ = boxes_.size();
                for (const Interval& stretch : columns.line(i, j)) add_stretch(i, j, stretch);
            }
        return std::move(boxes_);
    }

private:
    void add_stretch(int i, int j, const Interval& stretch) {
        const auto [first, last] = cells_met(model_, along_, stretch);
        for (int k = first; k <= last; ++k) {
            const Interval cell = cell_of(model_, along_, k);
            const Interval part{std::max(stretch.lower, cell.lower),
                                std::min(stretch.upper, cell.upper)};
            if (part.lower > part.upper) continue;
            // The family along u counts its cells by (v, along), that along v by (along, u).
            clip_across(u_, j, k, cell_of(model_, u_, i), across_u_);
            clip_across(v_, k, i, cell_of(model_, v_, j), across_v_);
            for (const Interval& v : across_v_)
                for (const Interval& u : across_u_) add_box(u, v, part);
        }
    }

    void clip_across(int axis, int i, int j, const Interval& cell, std::vector<Interval>& parts) {
        const ScanLines* family = families_[static_cast<size_t>(axis)];
        if (family)
            clip(family->line(i, j), cell, parts);
        else
            parts.assign(1, cell);
    }

    void add_box(const Interval& u, const Interval& v, const Interval& along) {
        Aabb box;
        box.min[u_] = u.lower, box.max[u_] = u.upper;
        box.min[v_] = v.lower, box.max[v_] = v.upper;
        box.min[along_] = along.lower, box.max[along_] = along.upper;
        if (boxes_.size() > first_of_column_ && continues(boxes_.back(), box))
            boxes_.back().max[along_] = along.upper;
        else
            boxes_.push_back(box);
    }

    bool continues(const Aabb& below, const Aabb& box) const {
        return below.min[u_] == box.min[u_] && below.max[u_] == box.max[u_]
               && below.min[v_] == box.min[v_] && below.max[v_] == box.max[v_]
               && below.max[along_] == box.min[along_];
    }

    const OuterModel& model_;
    int along_, u_, v_;
    std::array<const ScanLines*, 3> families_{};
    std::vector<Aabb> boxes_;
    size_t first_of_column_ = 0;
    std::vector<Interval> across_u_, across_v_;
};

/// Boxes that together contain every point of the body: in every cube of the grid the product of
/// the ranges of its columns, with runs of equal ones along the first family merged.
///
/// Proof:   core/distance/README.md, "Outer models".
inline std::vector<Aabb> boxes_of(const OuterModel& model) {
    if (model.families.empty()) return {};
    return BoxBuilder(model).run();
}

/// The current columns of a stock: the Z family.
inline OuterModel outer_model_of(const core::CutModel& stock) {
    const double error = core::scan_rounding(stock.outer_box.reach());
    OuterModel model{stock.lines.grid, stock.outer_box, {}};
    ScanLines columns(2, model.grid.count(0) + 1, model.grid.count(1) + 1);
    for (int j = 0; j < columns.v_count(); ++j)
        for (int i = 0; i < columns.u_count(); ++i)
            for (const Interval& part : stock.columns.line(i, j))
                columns.edit(i, j).add({part.lower - error, part.upper + error});
    model.families.push_back(std::move(columns));
    return model;
}

} // namespace test_support
