#include "hwsim/body_cover.h"

#include "core/distance/outer_model.h"
#include "hwsim/post_cover.h"

namespace hwsim {
namespace {

using core::ConvexShape;

/// The columns of an upright piece of revolution that stands somewhere.
core::ColumnFunction columns_at(const core::ProfileElement& element, const core::Vec3& at) {
    const core::ColumnFunction columns = columns_of(core::RevolvedProfile{{element}});
    return [columns, at](int axis, const core::Square& square) {
        const core::Square moved{square.x0 - at.x, square.x1 - at.x, square.y0 - at.y,
                                 square.y1 - at.y};
        core::IntervalList matter;
        for (const core::Interval& i : columns(axis, moved))
            matter.add({i.lower + at.z, i.upper + at.z});
        return matter;
    };
}

core::ColumnFunction columns_round(const core::ExactBody& body) {
    if (const auto* mesh = std::get_if<core::SolidMesh>(&body))
        return columns_of(core::Solid{*mesh});
    const auto& shape = std::get<ConvexShape>(body);
    if (shape.core != ConvexShape::Core::cone || !shape.upright || shape.place_count != 1)
        return columns_of(core::Solid{core::SolidBox{bounds(shape)}});
    core::ProfileElement element = shape.cone;
    element.margin = shape.margin;
    return columns_at(element, shape.places[0].at);
}

} // namespace

core::Result<std::vector<Record>> posts_round(const core::ExactBody& body, double spacing) {
    const core::Aabb box = bounds(body);
    const core::OuterModel model =
        outer_model(box, scan_grid(box, spacing), columns_round(body), {2});
    FEELER_TRY(const ColumnCells cells, cells_of(model));
    return posts_of(cells);
}

} // namespace hwsim
