#pragma once

#include <cstdint>

#include "core/base/vec.h"

namespace render {
struct SurfaceHit;
} // namespace render

namespace app::viewer {

enum class SectionAxis : uint8_t;
enum class SectionPick : uint8_t;
struct ViewModel;

/// Positions of a section plane along its normal, mm.
struct SectionRange {
    double least = 0.0, most = 0.0;
};

/// Begins a section through the closest pair, or the middle of the stock, and cuts away the half on
/// the side of the eye. False: there is nothing to cut.
bool open_section(ViewModel& model);

/// Cuts across an axis. Keeps the position if the axis stays.
void set_section_axis(ViewModel& model, SectionAxis axis);
/// Cuts through a point across a direction, which need not have unit length.
void set_section_plane(ViewModel& model, const core::Vec3& normal, const core::Vec3& through);
/// Cuts away the other side.
void flip_section(ViewModel& model);

/// The positions in which some of the stock remains; without a stock, of all that is shown.
SectionRange section_range(const ViewModel& model);
/// The position of the plane along its normal, from the program zero or the picked plane, mm.
double section_position(const ViewModel& model);
/// Moves the plane to a position, or to the nearest one in the range.
void set_section_position(ViewModel& model, double position);
/// A step for keys and the wheel, about a hundredth of the range: 1, 2 or 5 times a power of ten in
/// the unit of the window, mm.
double section_step(const ViewModel& model);

/// Begins to take clicks that define a plane; ends it if it has begun.
void pick_section(ViewModel& model, SectionPick pick);
/// Takes a click on a surface. Three points must not be on one line. False: no plane is being
/// picked.
bool take_section_click(ViewModel& model, const render::SurfaceHit& hit, double now);

} // namespace app::viewer
