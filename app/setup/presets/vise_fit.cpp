#include "app/setup/presets/vise_fit.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "app/setup/presets/preset_lists.h"
#include "core/base/text.h"

namespace app {

core::Result<ViseFit> vise_around(const Preset& vise, const PresetValues& values,
                                  const core::Aabb& box, double depth) {
    assert(vise.kind == PresetKind::vise);
    const PresetSizes size(vise.parameters, values);
    const PresetParameter& opening = *vise.parameter("opening");
    const double width = box.max.y - box.min.y;
    if (!fits(opening, width))
        return unfit_sizes(
            fmt::format("{} opens from {} to {} mm, but the part measures {} mm in Y", vise.name,
                        core::number_text(opening.least, 3), core::number_text(opening.greatest, 3),
                        core::number_text(width, 3)));
    const double deepest = std::min(size["jaw_height"], box.max.z - box.min.z);
    if (!(depth > 0.0 && depth <= deepest))
        return unfit_sizes(fmt::format("the part must reach more than 0 and at most {} mm into the "
                                       "jaws",
                                       core::number_text(deepest, 3)));
    return ViseFit{{(box.min.x + box.max.x) / 2, box.max.y, box.min.z + depth - size["jaw_height"]},
                   width};
}

} // namespace app
