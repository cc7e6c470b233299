#pragma once

#include <optional>
#include <vector>

#include "core/dbm/cut_model.h"
#include "core/motion/kinematics.h"
#include "core/sim/tool_description.h"

namespace core {

/// What has to be remembered of a tool that does not cut at its centre while it goes down: how the
/// stock stood before, and where the tool has been since.
///
/// Frame: places are those of the tip, along the tool's own axes.
struct CentreWatch {
    std::optional<CutModel> before;
    Mat3 orientation = Mat3(1.0);
    double top = 0.0;        // height at which it began to go down
    std::vector<Vec3> trail; // the last of it, as far as it is within the recess of the lowest
};

/// Where on a leg the centre of a tool is pushed into matter that its edges have not taken.
struct CentreContact {
    double share = 0.0;     // of the leg
    Vec3 place = Vec3(0.0); // of the tool's face there, in the stock's frame
};

/// How far the face of such a tool stands back from its edges, mm. With it the steepest ramp that
/// is still taken for cutting falls by recess / (2 * centre_radius): some 7 degrees.
double centre_recess(const ToolDescription& tool);

/// Follows a feed along one leg; `stock` is as it is before the leg. Call it for every leg of such
/// a tool, in order.
///
/// Proof: a tool that goes down meets a point at the height of its face for the first time when its
/// tip passes there. If the point has been under the centre ever since, no edge has come by.
std::optional<CentreContact> follow(CentreWatch& watch, const ToolDescription& tool,
                                    const RelativeLeg& leg, const CutModel& stock);

} // namespace core
