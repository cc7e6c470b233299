#include "gcode/flat_path.h"

#include "gcode/arc_geometry.h"

namespace gcode {

double turned_angle(const FlatArc& arc, FlatPoint start, FlatPoint end) {
    return std::abs(
        arc_angle({start.u, start.v}, {end.u, end.v}, {arc.centre.u, arc.centre.v}, arc.turns));
}

std::optional<Crossings> cross_line_and_circle(FlatPoint through, FlatPoint way, FlatPoint centre,
                                               double radius) {
    const FlatPoint along = direction(way);
    const double foot = dot(centre - through, along);
    const double distance = cross(along, centre - through);
    if (std::abs(distance) > radius) return {};
    const double half = std::sqrt((radius - distance) * (radius + distance));
    return Crossings{through + (foot - half) * along, through + (foot + half) * along};
}

std::optional<Crossings> cross_circles(FlatPoint centre, double radius, FlatPoint other_centre,
                                       double other_radius) {
    const FlatPoint way = other_centre - centre;
    const double apart = length(way);
    if (apart == 0.0 || apart > radius + other_radius || apart < std::abs(radius - other_radius))
        return {};
    const FlatPoint along = direction(way);
    const double foot = 0.5 * (apart + (radius - other_radius) * (radius + other_radius) / apart);
    const double half = std::sqrt(std::max(0.0, (radius - foot) * (radius + foot)));
    const FlatPoint middle = centre + foot * along;
    return Crossings{middle + half * left_of(along), middle - half * left_of(along)};
}

} // namespace gcode
