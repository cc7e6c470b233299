#include "core/motion/kinematics.h"

#include <algorithm>
#include <numbers>

#include "core/base/math.h"
#include "core/base/units.h"
#include "core/motion/machine.h"
#include "core/motion/path.h"

namespace core {
namespace {

/// The rotation about a line through the origin; exact for the frame's axes and multiples of 90
/// degrees.
Mat3 rotation_about(const Vec3& axis, double angle_deg) {
    const auto [sine, cosine] = sin_cos_deg(angle_deg);
    const double rest = 1.0 - cosine;
    Mat3 turn(0.0);
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) {
            const bool along = row == column && std::abs(axis[row]) == 1.0;
            turn[column][row] =
                along ? 1.0 : axis[row] * axis[column] * rest + (row == column ? cosine : 0.0);
        }
    const Vec3 s = sine * axis;
    turn[0][1] += s.z, turn[1][0] -= s.z;
    turn[1][2] += s.x, turn[2][1] -= s.x;
    turn[2][0] += s.y, turn[0][2] -= s.y;
    return turn;
}

/// A machine with its axes at some values. What the rotary axes turn is computed once.
class Posture {
public:
    Posture(const Machine& machine, const AxisValues& values) : machine_(machine), values_(values) {
        for (size_t i = 0; i < turns_.size(); ++i) {
            const MachineAxis& axis = machine.axes[first_rotary + i];
            if (!axis.present) continue;
            const Mat3 turn = rotation_about(axis.direction, way_of(first_rotary + i));
            turns_[i] = {turn, axis.point - turn * axis.point};
        }
    }

    void set_linear(size_t axis, double value) { values_[axis] = value; }

    /// The pose of a link.
    Transform of_link(LinkId link) const {
        Transform pose;
        while (link != LinkId::base) {
            const auto i = static_cast<size_t>(link);
            if (is_rotary(i))
                pose = turns_[i - first_rotary] * pose;
            else
                pose.translation += way_of(i) * machine_.axes[i].direction;
            link = machine_.axes[i].carrier;
        }
        return pose;
    }

    /// The pose of one mounted body relative to another.
    Transform target_from_mover(const Mount& target, const Mount& mover) const {
        return (of_link(target.link) * target.link_from_body).inverse()
               * (of_link(mover.link) * mover.link_from_body);
    }

    /// The position of the tool tip in the frame of the table link.
    Vec3 tip(double tool_length) const {
        return of_link(machine_.table).inverse()
               * (of_link(machine_.spindle) * Vec3(0.0, 0.0, -tool_length));
    }

private:
    static constexpr size_t first_rotary = 3;

    /// How far an axis moves what it carries, in its direction.
    double way_of(size_t axis) const {
        return machine_.axes[axis].side == Side::tool ? values_[axis] : -values_[axis];
    }

    const Machine& machine_;
    AxisValues values_;
    std::array<Transform, 3> turns_;
};

/// The rotary axes between a link and the base, starting at the base.
std::vector<size_t> rotary_chain(const Machine& machine, LinkId link) {
    std::vector<size_t> chain;
    while (link != LinkId::base) {
        const auto axis = static_cast<size_t>(link);
        if (is_rotary(axis)) chain.insert(chain.begin(), axis);
        link = machine.axes[axis].carrier;
    }
    return chain;
}

/// The angle plus whole turns that is closest to `from`, within the limits if possible.
double nearest_turn(const MachineAxis& axis, double from, double angle_deg) {
    double best = angle_deg + 360.0 * core::round((from - angle_deg) / 360.0);
    while (axis.max && best > *axis.max + 1e-9) best -= 360.0;
    while (axis.min && best < *axis.min - 1e-9) best += 360.0;
    return best;
}

bool within_limits(const MachineAxis& axis, double value) {
    return (!axis.min || value >= *axis.min - 1e-9) && (!axis.max || value <= *axis.max + 1e-9);
}

/// The rotary axes that affect the direction of the tool relative to the work, from the outermost
/// of the table to the one nearest to the tool. Each rotates all that follow it.
struct DirectionJoint {
    size_t axis;
    Vec3 about;
};

std::vector<DirectionJoint> direction_joints(const Machine& machine) {
    std::vector<DirectionJoint> joints;
    const std::vector<size_t> table = rotary_chain(machine, machine.table);
    for (auto it = table.rbegin(); it != table.rend(); ++it)
        joints.push_back({*it, machine.axes[*it].direction});
    for (const size_t axis : rotary_chain(machine, machine.spindle))
        joints.push_back({axis, machine.axes[axis].direction});
    return joints;
}

/// The angles t with a cos t + b sin t = c, degrees; empty if there is none.
std::vector<double> angles_with(double a, double b, double c) {
    const double size = core::hypot(a, b);
    if (size < 1e-12 || std::abs(c) > size * (1.0 + 1e-9)) return {};
    const double middle = angle_of(b, a);
    const double ratio = std::clamp(c / size, -1.0, 1.0);
    const double away = angle_of(std::sqrt(std::max(0.0, 1.0 - ratio * ratio)), ratio);
    return {(middle + away) * degrees_per_radian, (middle - away) * degrees_per_radian};
}

/// The angle about `axis` from one direction to another, degrees; both must have the same angle to
/// the axis.
std::optional<double> angle_between(const Vec3& axis, const Vec3& from, const Vec3& to) {
    const Vec3 u = from - glm::dot(from, axis) * axis, v = to - glm::dot(to, axis) * axis;
    if (glm::length(u) < 1e-9 || glm::length(v) < 1e-9) return std::nullopt;
    return angle_of(glm::dot(axis, glm::cross(u, v)), glm::dot(u, v)) * degrees_per_radian;
}

/// The rotations about a first and a second axis that turn Z to the wanted direction. The angle of
/// the second is the one that gives the right angle to the first axis.
void add_two_turns(const Machine& machine, const AxisValues& values, const DirectionJoint& outer,
                   const DirectionJoint& inner, const Vec3& wanted, std::vector<AxisValues>& ways) {
    const Vec3 z(0, 0, 1), k = inner.about, w = outer.about;
    // Z turned about k: z cos t + (k x z) sin t + k (k.z)(1 - cos t); its part along w is wanted.w.
    const double along = glm::dot(k, z) * glm::dot(k, w);
    for (const double angle : angles_with(glm::dot(z, w) - along, glm::dot(glm::cross(k, z), w),
                                          glm::dot(wanted, w) - along)) {
        const Vec3 leaning = rotation_about(k, angle) * z;
        AxisValues way = values;
        way[inner.axis] = nearest_turn(machine.axes[inner.axis], values[inner.axis], angle);
        // Along the outer axis itself any angle is right: keep the current one.
        if (const auto turn = angle_between(w, leaning, wanted))
            way[outer.axis] = nearest_turn(machine.axes[outer.axis], values[outer.axis], *turn);
        ways.push_back(way);
    }
}

/// All axes that move one link relative to another.
std::vector<size_t> axes_between(const Machine& machine, LinkId a, LinkId b) {
    std::vector<size_t> axes;
    for (LinkId link : {a, b}) {
        while (link != LinkId::base) {
            const auto axis = static_cast<size_t>(link);
            const auto known = std::find(axes.begin(), axes.end(), axis);
            // Axes that carry both links cancel out.
            if (known != axes.end())
                axes.erase(known);
            else
                axes.push_back(axis);
            link = machine.axes[axis].carrier;
        }
    }
    return axes;
}

/// The largest distance of a point from the given axes of rotation. Frame: the machine's.
double reach_from_axes(const Machine& machine, const std::vector<size_t>& axes,
                       const Posture& posture, const Vec3& point) {
    double reach = 0.0;
    for (const size_t i : axes) {
        if (!is_rotary(i)) continue;
        const MachineAxis& axis = machine.axes[i];
        const Transform pose = posture.of_link(axis.carrier);
        const Vec3 away = point - pose * axis.point;
        reach = std::max(reach, glm::length(glm::cross(pose.rotation * axis.direction, away)));
    }
    return reach;
}

/// An upper bound of the distance of a point from the rotary axes of a chain.
double chain_reach(const Machine& machine, LinkId link, const Vec3& point) {
    double reach = 0.0;
    Vec3 here = point;
    while (link != LinkId::base) {
        const auto i = static_cast<size_t>(link);
        const MachineAxis& axis = machine.axes[i];
        if (is_rotary(i)) {
            reach += glm::distance(here, axis.point);
            here = axis.point;
        } else if (reach > 0.0 && is_turned_by_axes(machine, axis.carrier)) {
            reach += std::max(std::abs(axis.min.value_or(0.0)), std::abs(axis.max.value_or(0.0)));
        }
        link = axis.carrier;
    }
    return reach;
}

AxisValues half_way(const Leg& leg) {
    AxisValues values = leg.positions[0];
    for (size_t i = 0; i < axis_count; ++i)
        if (leg.positions[1][i] != values[i]) values[i] = 0.5 * (values[i] + leg.positions[1][i]);
    return values;
}

/// The translation of a link by linear axes.
Vec3 shift_of(const Machine& machine, LinkId link, const AxisValues& values) {
    Vec3 shift(0.0);
    while (link != LinkId::base) {
        const auto i = static_cast<size_t>(link);
        const MachineAxis& axis = machine.axes[i];
        shift += (axis.side == Side::tool ? values[i] : -values[i]) * axis.direction;
        link = axis.carrier;
    }
    return shift;
}

/// The pose on a machine with linear axes only.
Transform shifted_pose(const Machine& machine, const Mount& target, const Mount& mover,
                       const AxisValues& values) {
    const Vec3 shift =
        shift_of(machine, mover.link, values) - shift_of(machine, target.link, values);
    const Mat3 back = glm::transpose(target.link_from_body.rotation);
    return {back * mover.link_from_body.rotation,
            back * (shift - target.link_from_body.translation + mover.link_from_body.translation)};
}

/// A leg on which the mover does not rotate relative to the target.
RelativeLeg without_turning(const Machine& machine, const Mount& target, const Mover& mover,
                            const Leg& leg) {
    RelativeLeg relative;
    relative.lasting_error = mover.form_error;
    relative.deviation = mover.deviation;
    relative.error = leg.path_error + mover.form_error;
    for (const AxisValues& position : leg.positions) {
        const Transform pose = machine.has_rotary()
                                   ? target_from_mover(machine, target, mover.mount, position)
                                   : shifted_pose(machine, target, mover.mount, position);
        relative.orientation = pose.rotation;
        relative.positions.push_back(pose.translation);
    }
    relative.travel =
        glm::distance(relative.positions.front(), relative.positions.back()) + leg.path_error;
    return relative;
}

} // namespace

Transform machine_from_link(const Machine& machine, LinkId link, const AxisValues& values) {
    return Posture(machine, values).of_link(link);
}

bool is_turned_by_axes(const Machine& machine, LinkId link) {
    return !rotary_chain(machine, link).empty();
}

bool is_on_table_side(const Machine& machine, LinkId link) {
    return link != LinkId::base && machine.axes[static_cast<size_t>(link)].side == Side::table;
}

Transform target_from_mover(const Machine& machine, const Mount& target, const Mount& mover,
                            const AxisValues& values) {
    return Posture(machine, values).target_from_mover(target, mover);
}

Vec3 tip_position(const Machine& machine, const AxisValues& values, double tool_length) {
    return Posture(machine, values).tip(tool_length);
}

std::optional<AxisValues> reach_tip(const Machine& machine, const AxisValues& values,
                                    const Vec3& tip, double tool_length) {
    AxisValues reached = values;
    reached[0] = reached[1] = reached[2] = 0.0;
    // With the rotary axes held, the tip is an affine function of X, Y and Z.
    Posture posture(machine, reached);
    const Vec3 origin = posture.tip(tool_length);
    Mat3 by_axis(0.0);
    for (size_t i = 0; i < 3; ++i) {
        posture.set_linear(i, 1.0);
        by_axis[static_cast<int>(i)] = posture.tip(tool_length) - origin;
        posture.set_linear(i, 0.0);
    }
    if (std::abs(glm::determinant(by_axis)) < 1e-9) return std::nullopt;
    const Vec3 linear = glm::inverse(by_axis) * (tip - origin);
    for (size_t i = 0; i < 3; ++i) reached[i] = linear[static_cast<int>(i)];
    return reached;
}

double turn_of(const Machine& machine, const AxisValues& from, const AxisValues& to) {
    double degrees = 0.0;
    for (size_t i = 3; i < 6; ++i)
        if (machine.axes[i].present) degrees += std::abs(to[i] - from[i]);
    return degrees / degrees_per_radian;
}

double tip_reach(const Machine& machine, const Vec3& tip, double tool_length) {
    return std::max(chain_reach(machine, machine.table, tip),
                    chain_reach(machine, machine.spindle, Vec3(0.0, 0.0, -tool_length)));
}

namespace {

/// A bound of the angle by which the Z axis of a body tilts over a leg, radians; `mover_pose` is
/// that of the body at half time.
///
/// Proof:   core/sim/README.md, "Turning".
double tilt_of_axis(const Machine& machine, const std::vector<size_t>& axes, const Leg& leg,
                    const Posture& middle, const Mat3& mover_pose, double turn) {
    constexpr double rounding = 1e-12;
    double tilt = 0.0;
    for (const size_t i : axes) {
        if (!is_rotary(i)) continue;
        const double by = std::abs(leg.positions[1][i] - leg.positions[0][i]) / degrees_per_radian;
        const MachineAxis& axis = machine.axes[i];
        const Vec3 about = middle.of_link(axis.carrier).rotation * axis.direction;
        const double sine = glm::length(glm::cross(about, mover_pose[2])) + 0.5 * (turn - by);
        tilt += by * std::min(1.0, sine + rounding);
    }
    return tilt;
}

/// How far the surface of a body gets along its own normal while its axis tilts to either side by
/// half of this angle, mm.
///
/// Proof:   core/sim/README.md, "Flutes in parts".
double tilt_error(const Mover& mover, double tilt) {
    const double half = 0.5 * tilt;
    const double of_points = half * mover.reach;
    if (mover.arm == infinity) return of_points;
    if (mover.overlap == 0.0) return std::min(of_points, half * mover.arm);
    const double needed = 1.6 * of_points; // of the overlap
    if (needed > 0.5 * mover.overlap) return of_points;
    return std::min(of_points, half * (mover.arm + needed));
}

/// Adds to a leg what the errors of the rotary axes between its links turn the body by. No point of
/// the body is farther from these axes than `reach`.
void add_turn_error(RelativeLeg& relative, const Leg& leg, double reach) {
    const double error = 1.01 * leg.turn_error * reach;
    relative.error += error;
    relative.lasting_error += error;
    relative.travel += 2.0 * error;
}

/// The leg of a body without its play.
RelativeLeg rigid_leg(const Machine& machine, const Mount& target, const Mover& mover,
                      const Leg& leg) {
    if (!machine.has_rotary()) return without_turning(machine, target, mover, leg);
    const std::vector<size_t> axes = axes_between(machine, target.link, mover.mount.link);
    double turn = 0.0, travel = 0.0;
    if (leg.positions.size() == 2) {
        for (const size_t i : axes) {
            const double by = std::abs(leg.positions[1][i] - leg.positions[0][i]);
            (is_rotary(i) ? turn : travel) += is_rotary(i) ? by / degrees_per_radian : by;
        }
    }
    if (turn == 0.0) {
        RelativeLeg relative = without_turning(machine, target, mover, leg);
        if (leg.turn_error == 0.0) return relative;
        double reach = 0.0;
        for (const AxisValues& position : leg.positions) {
            const Posture posture(machine, position);
            const Vec3 centre =
                posture.of_link(mover.mount.link) * (mover.mount.link_from_body * mover.centre);
            reach = std::max(reach, reach_from_axes(machine, axes, posture, centre));
        }
        const bool turns = std::any_of(axes.begin(), axes.end(), is_rotary);
        if (turns) add_turn_error(relative, leg, reach + mover.reach);
        return relative;
    }

    const Posture middle(machine, half_way(leg));
    RelativeLeg relative{.orientation = middle.target_from_mover(target, mover.mount).rotation,
                         .turns = true};
    for (const AxisValues& position : leg.positions)
        relative.positions.push_back(target_from_mover(machine, target, mover.mount, position)
                                         * mover.centre
                                     - relative.orientation * mover.centre);
    const Transform mover_pose = middle.of_link(mover.mount.link) * mover.mount.link_from_body;
    const Vec3 centre = mover_pose * mover.centre;
    const double bound = 1.0 - 0.5 * turn;
    if (bound < 0.75) {
        relative.error = relative.travel = infinity;
        return relative;
    }
    const double reach = (reach_from_axes(machine, axes, middle, centre) + 0.5 * travel) / bound;
    const double curve = 0.25 * turn * (turn * reach + travel);
    const double tilt = mover.is_revolved
                            ? tilt_of_axis(machine, axes, leg, middle, mover_pose.rotation, turn)
                            : turn;
    relative.lasting_error = mover.form_error + leg.lasting_error;
    relative.deviation = mover.deviation;
    relative.error = leg.path_error + mover.form_error + curve + tilt_error(mover, tilt);
    // The centre stays within `curve` of its chord, and the body turns about it. While the linear
    // axes follow the rotary ones, that is far less than what the axes travel.
    const double chord = glm::distance(relative.positions[0], relative.positions[1]);
    relative.travel =
        std::min(turn * (reach + mover.reach) + travel, chord + curve + tilt * mover.reach)
        + leg.path_error;
    if (leg.turn_error > 0.0) add_turn_error(relative, leg, reach + mover.reach);
    return relative;
}

} // namespace

void add_play_as_error(RelativeLeg& leg, const Play& play) {
    for (Vec3& position : leg.positions) position += 0.5 * (play.from + play.to);
    const double half = 0.5 * glm::distance(play.from, play.to);
    leg.error += half;
    leg.lasting_error += half;
}

void add_play(RelativeLeg& leg, const Play& play) {
    if (play.none()) return;
    if (2 * leg.positions.size() > ConvexShape::max_positions) return add_play_as_error(leg, play);
    std::vector<Vec3> positions;
    for (const Vec3& by : {play.from, play.to})
        for (const Vec3& position : leg.positions) positions.push_back(position + by);
    leg.positions = std::move(positions);
}

namespace {

/// A body can be swept over so many positions. A box contains the hull of more.
void limit_positions(std::vector<Vec3>& positions) {
    if (positions.size() <= ConvexShape::max_positions) return;
    Vec3 low = positions.front(), high = low;
    for (const Vec3& position : positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    positions.clear();
    for (const double x : {low.x, high.x})
        for (const double y : {low.y, high.y})
            for (const double z : {low.z, high.z}) positions.push_back({x, y, z});
}

} // namespace

RelativeLeg relative_leg(const Machine& machine, const Mount& target, const Mover& mover,
                         const Leg& leg) {
    RelativeLeg relative = rigid_leg(machine, target, mover, leg);
    limit_positions(relative.positions);
    if (mover.play.none()) return relative;
    add_play(relative, rotated(relative.orientation, mover.play));
    if (!relative.turns) return relative;
    // The body, and with it the displacement, turns by half of the leg's angle to either side.
    const double turn = turn_of(machine, leg.positions.front(), leg.positions.back());
    const double longest = std::max(glm::length(mover.play.from), glm::length(mover.play.to));
    relative.error += 0.5 * turn * longest;
    relative.travel += turn * longest;
    return relative;
}

namespace {

/// The greatest of 2 |sin(angle / 2)| between two angles, degrees.
double greatest_chord(double from_deg, double to_deg) {
    const double low = std::min(from_deg, to_deg), high = std::max(from_deg, to_deg);
    // At odd multiples of 180 degrees it is 2.
    if (std::floor((high - 180.0) / 360.0) != std::floor((low - 180.0) / 360.0)) return 2.0;
    const auto at = [](double angle) { return 2.0 * std::abs(sin_cos_deg(0.5 * angle).sin); };
    return std::max(at(low), at(high));
}

/// The bound on a piece of a leg: `posture` is at its first position, and each axis is between
/// `low` and `high` on it.
double axis_tolerance_on_piece(const Machine& machine, const std::vector<size_t>& axes,
                               const Mover& mover, const Posture& posture, const AxisValues& low,
                               const AxisValues& high) {
    const Vec3 centre =
        posture.of_link(mover.mount.link) * (mover.mount.link_from_body * mover.centre);
    double turn = 0.0, travel = 0.0, farthest = 0.0;
    for (const size_t i : axes) {
        const double by = high[i] - low[i];
        (is_rotary(i) ? turn : travel) += is_rotary(i) ? by / degrees_per_radian : by;
        if (!is_rotary(i)) continue;
        const Vec3 point = posture.of_link(machine.axes[i].carrier) * machine.axes[i].point;
        farthest = std::max(farthest, glm::distance(centre, point) + mover.reach);
    }
    constexpr double most_turn = 10.0; // radians; more comes from slips, and would overflow
    if (turn > most_turn) return infinity;
    const double distance = (farthest + travel) * core::exp(turn);
    double error = 0.0, slope = 0.0;
    for (const size_t i : axes) {
        const MachineAxis& axis = machine.axes[i];
        if (!is_rotary(i)) continue;
        const double chord = greatest_chord(low[i], high[i]);
        error += chord * (axis.point_tolerance + axis.direction_tolerance * distance);
        slope += chord * axis.direction_tolerance;
    }
    return slope < 0.5 ? 1.001 * error / (1.0 - slope) : infinity;
}

} // namespace

double axis_tolerance_error(const Machine& machine, LinkId target, const Mover& mover,
                            const Leg& leg) {
    const std::vector<size_t> axes = axes_between(machine, target, mover.mount.link);
    const auto is_uncertain = [&](size_t i) {
        return is_rotary(i)
               && (machine.axes[i].point_tolerance > 0.0
                   || machine.axes[i].direction_tolerance > 0.0);
    };
    if (std::none_of(axes.begin(), axes.end(), is_uncertain)) return 0.0;
    constexpr double longest_turn = 0.1; // radians, of a piece of a straight leg
    const bool is_straight = leg.straight && leg.positions.size() == 2;
    const double turn =
        is_straight ? turn_of(machine, leg.positions.front(), leg.positions.back()) : 0.0;
    const int pieces =
        std::max(1, static_cast<int>(std::min(1000.0, std::ceil(turn / longest_turn))));
    const auto at = [&](int piece) {
        const double part = static_cast<double>(piece) / pieces;
        AxisValues values = leg.positions.front();
        if (is_straight)
            for (size_t i = 0; i < axis_count; ++i)
                values[i] += part * (leg.positions.back()[i] - values[i]);
        return values;
    };
    double error = 0.0;
    for (int piece = 0; piece < pieces; ++piece) {
        const AxisValues first = at(piece);
        AxisValues low = first, high = first;
        const auto extend = [&](const AxisValues& values) {
            for (size_t i = 0; i < axis_count; ++i) {
                low[i] = std::min(low[i], values[i]);
                high[i] = std::max(high[i], values[i]);
            }
        };
        if (is_straight)
            extend(at(piece + 1));
        else
            for (const AxisValues& position : leg.positions) extend(position);
        error = std::max(error, axis_tolerance_on_piece(machine, axes, mover,
                                                        Posture(machine, first), low, high));
    }
    return error;
}

std::vector<AxisValues> ways_to_point_tool(const Machine& machine, const AxisValues& values,
                                           const Vec3& tool_axis) {
    const Vec3 wanted = glm::normalize(tool_axis);
    const std::vector<DirectionJoint> joints = direction_joints(machine);
    std::vector<AxisValues> ways = {values};
    for (size_t i = 0; i < joints.size(); ++i) {
        if (const auto turn = angle_between(joints[i].about, Vec3(0, 0, 1), wanted)) {
            AxisValues way = values;
            for (const DirectionJoint& other : joints) way[other.axis] = 0.0;
            way[joints[i].axis] =
                nearest_turn(machine.axes[joints[i].axis], values[joints[i].axis], *turn);
            ways.push_back(way);
        }
        for (size_t j = i + 1; j < joints.size(); ++j)
            add_two_turns(machine, values, joints[i], joints[j], wanted, ways);
    }
    const auto turning = [&](const AxisValues& way) {
        double sum = 0.0;
        for (const DirectionJoint& moved : joints)
            sum += std::abs(way[moved.axis] - values[moved.axis]);
        return sum;
    };
    std::erase_if(ways, [&](const AxisValues& way) {
        return glm::distance(tool_frame(machine, way)[2], wanted) >= 1e-9
               || std::any_of(joints.begin(), joints.end(), [&](const DirectionJoint& moved) {
                      return !within_limits(machine.axes[moved.axis], way[moved.axis]);
                  });
    });
    std::stable_sort(ways.begin(), ways.end(), [&](const AxisValues& a, const AxisValues& b) {
        return turning(a) < turning(b);
    });
    std::vector<AxisValues> different;
    const auto tilt = tilting_axis(machine);
    for (const AxisValues& way : ways) {
        constexpr double same = 1e-6; // degrees
        const auto is_known = [&](const AxisValues& other) {
            return !tilt || std::abs(other[*tilt] - way[*tilt]) < same;
        };
        if (std::none_of(different.begin(), different.end(), is_known)) different.push_back(way);
    }
    return different;
}

std::optional<AxisValues> point_tool(const Machine& machine, const AxisValues& values,
                                     const Vec3& tool_axis) {
    const std::vector<AxisValues> ways = ways_to_point_tool(machine, values, tool_axis);
    return ways.empty() ? std::nullopt : std::optional(ways.front());
}

std::optional<size_t> tilting_axis(const Machine& machine) {
    const auto tilts = [&](size_t axis) {
        return std::abs(machine.axes[axis].direction.z) < 1.0 - 1e-9;
    };
    for (const size_t axis : rotary_chain(machine, machine.table))
        if (tilts(axis)) return axis;
    const std::vector<size_t> head = rotary_chain(machine, machine.spindle);
    const auto found = std::find_if(head.rbegin(), head.rend(), tilts);
    return found == head.rend() ? std::nullopt : std::optional(*found);
}

std::optional<size_t> axis_next_to_work(const Machine& machine) {
    const std::vector<size_t> chain = rotary_chain(machine, machine.table);
    return chain.empty() ? std::nullopt : std::optional(chain.back());
}

Mat3 tool_frame(const Machine& machine, const AxisValues& values) {
    return glm::transpose(machine_from_link(machine, machine.table, values).rotation)
           * machine_from_link(machine, machine.spindle, values).rotation;
}

} // namespace core
