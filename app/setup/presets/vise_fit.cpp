#include "app/setup/presets/vise_fit.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "app/setup/presets/preset_lists.h"
#include "core/base/text.h"

namespace app {

namespace {

core::Vec3 turned_quarter(const core::Vec3& p) { return {-p.y, p.x, p.z}; }

core::Aabb turned_back(const core::Aabb& box) {
    return {{box.min.y, -box.max.x, box.min.z}, {box.max.y, -box.min.x, box.max.z}};
}

} // namespace

core::Result<ViseFit> vise_around(const Preset& vise, const PresetValues& values,
                                  const core::Aabb& part, double depth, int quarter_turns) {
    assert(vise.kind == PresetKind::vise);
    const int turns = (quarter_turns % 4 + 4) % 4;
    core::Aabb box = part; // in the axes of the vise
    for (int i = 0; i < turns; ++i) box = turned_back(box);
    const PresetSizes size(vise.parameters, values);
    const PresetParameter& opening = *vise.parameter("opening");
    const double width = box.max.y - box.min.y;
    if (!fits(opening, width))
        return unfit_sizes(
            fmt::format("{} opens from {} to {} mm, but the part measures {} mm in {}", vise.name,
                        core::number_text(opening.least, 3), core::number_text(opening.greatest, 3),
                        core::number_text(width, 3), turns % 2 == 0 ? "Y" : "X"));
    const double deepest = std::min(size["jaw_height"], box.max.z - box.min.z);
    if (!(depth > 0.0 && depth <= deepest))
        return unfit_sizes(fmt::format("the part must reach more than 0 and at most {} mm into the "
                                       "jaws",
                                       core::number_text(deepest, 3)));
    core::Vec3 at((box.min.x + box.max.x) / 2, box.max.y, box.min.z + depth - size["jaw_height"]);
    for (int i = 0; i < turns; ++i) at = turned_quarter(at);
    return ViseFit{at, width};
}

} // namespace app
