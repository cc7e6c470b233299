// Random five-axis programs on random machines: every reported interval is compared with dense
// sampling by kinematics and distances of this file alone.
//
// FEELER_FIVE_AXIS_PROGRAMS, _BLOCKS and _SEED set how many programs of each control run, how long
// they are and where the random numbers start. Programs with wrong intervals, or with
// FEELER_FIVE_AXIS_KEEP all of them, are written to the folder FEELER_FIVE_AXIS_SAVE.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <numbers>
#include <optional>
#include <queue>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/checked.h"

namespace app_test {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double endless = 1e300;
constexpr double search_limit = 50.0; // mm: Feeler does not measure beyond it

// ---------------------------------------------------------------------------------------------
// Vectors, rotations, poses.

struct Vec {
    double x = 0.0, y = 0.0, z = 0.0;
};
Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator-(const Vec& a) { return {-a.x, -a.y, -a.z}; }
Vec operator*(double f, const Vec& a) { return {f * a.x, f * a.y, f * a.z}; }
double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec cross(const Vec& a, const Vec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec unit(const Vec& a) { return (1.0 / length(a)) * a; }

/// Rows of a rotation.
struct Rotation {
    Vec x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    Vec operator*(const Vec& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
    Vec back(const Vec& v) const { return v.x * x + v.y * y + v.z * z; }
    Rotation inverse() const { return {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}; }
    Rotation operator*(const Rotation& other) const {
        const Rotation columns = other.inverse();
        const auto row = [&](const Vec& v) {
            return Vec{dot(v, columns.x), dot(v, columns.y), dot(v, columns.z)};
        };
        return {row(x), row(y), row(z)};
    }
};

/// By Rodrigues' formula.
Rotation about(const Vec& axis, double degrees) {
    // Multiples of a quarter turn are exact.
    double s = std::sin(degrees * degree), c = std::cos(degrees * degree);
    const double quarters = degrees / 90.0;
    if (quarters == std::floor(quarters)) s = std::round(s), c = std::round(c);
    const auto column = [&](const Vec& v) {
        return c * v + s * cross(axis, v) + (1.0 - c) * dot(axis, v) * axis;
    };
    return Rotation{column({1, 0, 0}), column({0, 1, 0}), column({0, 0, 1})}.inverse();
}

const Vec along_x{1, 0, 0}, along_y{0, 1, 0}, along_z{0, 0, 1};

/// About X, then Y, then Z, about fixed axes.
Rotation about_xyz(const Vec& degrees) {
    return about(along_z, degrees.z) * about(along_y, degrees.y) * about(along_x, degrees.x);
}

struct Pose {
    Rotation r;
    Vec t;

    Vec operator*(const Vec& v) const { return r * v + t; }
    Pose operator*(const Pose& other) const { return {r * other.r, r * other.t + t}; }
    Pose inverse() const { return {r.inverse(), -r.back(t)}; }
};

// ---------------------------------------------------------------------------------------------
// Convex shapes and their distance.

/// The convex hull of discs about Z, each made larger by a ball; or a box.
struct Shape {
    struct Disc {
        double radius, z, ball;
    };
    std::vector<Disc> discs;
    Vec half; // of the box, whose centre is the origin
    Pose place;
    Vec centre; // of a ball around it, in the frame of its body
    double around = 0.0;

    Vec farthest(const Vec& towards) const {
        const Vec d = place.r.back(towards);
        if (discs.empty())
            return place
                   * Vec{std::copysign(half.x, d.x), std::copysign(half.y, d.y),
                         std::copysign(half.z, d.z)};
        const double across = std::sqrt(d.x * d.x + d.y * d.y), all = length(d);
        const double ux = across > 0.0 ? d.x / across : 1.0, uy = across > 0.0 ? d.y / across : 0.0;
        double most = -endless;
        Vec found;
        for (const Disc& disc : discs) {
            const double reach = disc.radius * across + disc.z * d.z + disc.ball * all;
            if (reach <= most) continue;
            most = reach;
            found = {disc.radius * ux, disc.radius * uy, disc.z};
            if (all > 0.0) found = found + (disc.ball / all) * d;
        }
        return place * found;
    }

    void finish() {
        const Vec low{-farthest({-1, 0, 0}).x, -farthest({0, -1, 0}).y, -farthest({0, 0, -1}).z};
        const Vec high{farthest({1, 0, 0}).x, farthest({0, 1, 0}).y, farthest({0, 0, 1}).z};
        centre = 0.5 * (high - low);
        around = 0.5 * length(high + low);
    }
};

Shape box_of(const Vec& low, const Vec& high, const Pose& place) {
    Shape shape;
    shape.half = 0.5 * (high - low);
    shape.place = place * Pose{{}, 0.5 * (low + high)};
    shape.finish();
    return shape;
}

Shape turned_of(std::vector<Shape::Disc> discs, const Pose& place) {
    Shape shape;
    shape.discs = std::move(discs);
    shape.place = place;
    shape.finish();
    return shape;
}

/// Between these bounds; `most` is the distance of two points that exist.
struct Gap {
    double least = 0.0, most = 0.0;
};

/// The point nearest to the origin of the hull of up to four points, the last of which must count;
/// drops those that do not.
Vec nearest_of(std::array<Vec, 4>& points, int& count) {
    const int last = count - 1;
    Vec best = points[last];
    double best_square = dot(best, best);
    int best_set = 0;
    for (int set = 1; set < (1 << last); ++set) {
        std::array<Vec, 3> edge;
        int n = 0;
        for (int i = 0; i < last; ++i)
            if (set & (1 << i)) edge[n++] = points[i] - points[last];
        // Least squares: |p + sum f_i e_i|, with the normal equations solved by Cramer's rule.
        const Vec& p = points[last];
        std::array<double, 3> f{};
        if (n == 1) {
            const double square = dot(edge[0], edge[0]);
            if (!(square > 0.0)) continue;
            f[0] = -dot(p, edge[0]) / square;
        } else if (n == 2) {
            const Vec normal = cross(edge[0], edge[1]);
            const double square = dot(normal, normal);
            if (!(square > 1e-26 * dot(edge[0], edge[0]) * dot(edge[1], edge[1]))) continue;
            f[0] = dot(cross(-p, edge[1]), normal) / square;
            f[1] = dot(cross(edge[0], -p), normal) / square;
        } else {
            const double volume = dot(edge[0], cross(edge[1], edge[2]));
            if (!(std::abs(volume) > 1e-13 * length(edge[0]) * length(edge[1]) * length(edge[2])))
                continue;
            f[0] = dot(-p, cross(edge[1], edge[2])) / volume;
            f[1] = dot(edge[0], cross(-p, edge[2])) / volume;
            f[2] = dot(edge[0], cross(edge[1], -p)) / volume;
        }
        double sum = 0.0;
        bool inside = true;
        Vec at = p;
        for (int i = 0; i < n; ++i) {
            inside = inside && f[i] >= 0.0;
            sum += f[i];
            at = at + f[i] * edge[i];
        }
        if (!inside || sum > 1.0) continue;
        if (n == 3) at = {};
        const double square = dot(at, at);
        if (square >= best_square) continue;
        best = at, best_square = square, best_set = set;
    }
    int kept = 0;
    for (int i = 0; i < last; ++i)
        if (best_set & (1 << i)) points[kept++] = points[i];
    points[kept++] = points[last];
    count = kept;
    return best;
}

/// The algorithm of Gilbert, Johnson and Keerthi; its own bounds say how accurate it is. `b_from_a`
/// places A in the frame of B. `from` is a direction to begin with, and the last one found.
Gap gap_of(const Shape& a, const Shape& b, const Pose& b_from_a, Vec& from) {
    std::array<Vec, 4> points;
    int count = 0;
    Vec v = dot(from, from) > 0.0 ? from : b_from_a * a.centre - b.centre;
    if (!(dot(v, v) > 0.0)) v = {0, 0, 1};
    Gap gap{0.0, endless};
    for (int step = 0; step < 200; ++step) {
        const Vec w = b_from_a * a.farthest(b_from_a.r.back(-v)) - b.farthest(v);
        const double size = length(v);
        gap.least = std::max(gap.least, dot(v, w) / size);
        if (step > 0 && size - gap.least < 1e-9 + 1e-13 * size) break;
        if (count == 4) break; // encloses the origin
        points[count++] = w;
        const Vec next = nearest_of(points, count);
        const double most = length(next);
        if (step > 0 && most >= gap.most) break; // no more to gain
        gap.most = most;
        if (most < 1e-10) return {0.0, most};
        v = next;
    }
    from = v;
    return gap;
}

// ---------------------------------------------------------------------------------------------
// Machines.

/// X, Y, Z and two rotary axes, in this order.
using Joints = std::array<double, 5>;

struct Axis {
    char letter = 0;
    int slot = 0; // in Joints
    bool table = false;
    Vec direction, point;

    bool rotary() const { return slot >= 3; }
};

struct Machine {
    std::vector<Axis> axes; // as listed: each carries the next one of its side

    /// -1: the frame of the machine.
    int last_of(bool table) const {
        int found = -1;
        for (size_t i = 0; i < axes.size(); ++i)
            if (axes[i].table == table) found = static_cast<int>(i);
        return found;
    }
    const Axis& rotary(int which) const {
        for (const Axis& axis : axes)
            if (axis.slot == 3 + which) return axis;
        std::abort();
    }

    /// What the rotary axes turn, each for itself.
    using Turns = std::array<Pose, 2>;
    Turns turns(const Joints& at) const {
        Turns found;
        for (const Axis& axis : axes) {
            if (!axis.rotary()) continue;
            // The direction is that of the tool relative to the work: a table turns the other way.
            const double value = at[axis.slot];
            const Rotation turn = about(axis.direction, axis.table ? -value : value);
            found[axis.slot - 3] = {turn, axis.point - turn * axis.point};
        }
        return found;
    }
    /// Where an axis carries what was in the machine frame with all axes at 0.
    Pose link(int index, const Joints& at, const Turns& turns) const {
        Pose pose;
        if (index < 0) return pose;
        for (int i = 0; i <= index; ++i) {
            const Axis& axis = axes[i];
            if (axis.table != axes[index].table) continue;
            if (axis.rotary()) {
                pose = pose * turns[axis.slot - 3];
            } else {
                // A table moves the other way, so that the tool moves along the direction.
                const double value = at[axis.slot];
                pose.t = pose.t + pose.r * ((axis.table ? -value : value) * axis.direction);
            }
        }
        return pose;
    }
    Pose link(int index, const Joints& at) const { return link(index, at, turns(at)); }
    Pose tool_in_table(const Joints& at) const { return tool_in_table(at, turns(at)); }
    Pose tool_in_table(const Joints& at, const Turns& turns) const {
        return link(last_of(true), at, turns).inverse() * link(last_of(false), at, turns);
    }
    /// X, Y and Z that bring a point of the spindle, `below` the gauge line, to a point of the
    /// table. Where it is depends on them linearly.
    void reach(Joints& at, double below, const Vec& target) const {
        const Turns turned = turns(at);
        const auto place = [&](const Vec& linear) {
            Joints joints = at;
            joints[0] = linear.x, joints[1] = linear.y, joints[2] = linear.z;
            return tool_in_table(joints, turned) * Vec{0, 0, -below};
        };
        const Vec base = place({});
        const Vec x = place({1, 0, 0}) - base, y = place({0, 1, 0}) - base,
                  z = place({0, 0, 1}) - base;
        // These differences lose digits to rounding far away, so a second step corrects.
        const double volume = dot(x, cross(y, z));
        Vec linear;
        for (int step = 0; step < 2; ++step) {
            const Vec missing = target - place(linear);
            linear = linear
                     + Vec{dot(missing, cross(y, z)) / volume, dot(x, cross(missing, z)) / volume,
                           dot(x, cross(y, missing)) / volume};
        }
        at[0] = linear.x, at[1] = linear.y, at[2] = linear.z;
    }
    /// Of the directions of X, Y and Z relative to the table: 0 if they lie in a plane.
    double volume(const Joints& at) const {
        std::array<Vec, 3> moved;
        const Turns turned = turns(at);
        for (int i = 0; i < 3; ++i) {
            Joints one = at;
            one[i] += 1.0;
            moved[i] = tool_in_table(one, turned).t - tool_in_table(at, turned).t;
        }
        return std::abs(dot(moved[0], cross(moved[1], moved[2])));
    }
    /// The direction of the tool from its tip, in the frame of the table.
    Vec direction(const Joints& at) const { return tool_in_table(at).r * along_z; }

    /// The rotary positions with this direction; the first has the greater angle between the two
    /// axes. Empty if there are none, or if it is within `margin` of a pole.
    std::vector<std::array<double, 2>> solve(const Vec& towards, double margin) const;
};

/// The angle about an axis that turns a vector to another one.
double angle_between(const Vec& axis, const Vec& from, const Vec& to) {
    const Vec a = from - dot(axis, from) * axis, b = to - dot(axis, to) * axis;
    return std::atan2(dot(axis, cross(a, b)), dot(a, b)) / degree;
}

std::vector<std::array<double, 2>> Machine::solve(const Vec& towards, double margin) const {
    // The tool in the table: turns of the table backwards from the last one, then of the head.
    std::vector<const Axis*> order;
    std::vector<double> sign;
    for (size_t i = axes.size(); i-- > 0;)
        if (axes[i].rotary() && axes[i].table) order.push_back(&axes[i]), sign.push_back(1.0);
    for (const Axis& axis : axes)
        if (axis.rotary() && !axis.table) order.push_back(&axis), sign.push_back(1.0);
    const Vec first = order[0]->direction, second = order[1]->direction;
    // first and second turn along_z to `towards`: there is a vector c with c . second = z . second
    // and c . first = towards . first, of unit length.
    const double d = dot(first, second), u = dot(second, along_z), v = dot(first, towards);
    const double square = 1.0 - d * d;
    const double alpha = (d * u - v) / (d * d - 1.0), beta = (d * v - u) / (d * d - 1.0);
    const double rest = (1.0 - alpha * alpha - beta * beta - 2.0 * alpha * beta * d) / square;
    if (!(rest > 0.0)) return {};
    if (std::acos(std::min(1.0, std::abs(v))) / degree < margin) return {};
    if (std::sqrt(rest) < std::sin(margin * degree)) return {};
    std::vector<std::array<double, 2>> found;
    for (const double side : {1.0, -1.0}) {
        const Vec c = alpha * first + beta * second + side * std::sqrt(rest) * cross(first, second);
        std::array<double, 2> angles{};
        angles[order[1]->slot - 3] = sign[1] * angle_between(second, along_z, c);
        angles[order[0]->slot - 3] = sign[0] * angle_between(first, c, towards);
        found.push_back(angles);
    }
    return found;
}

/// The same angle nearest to another one.
double nearest_turn(double angle, double to) {
    return angle + 360.0 * std::round((to - angle) / 360.0);
}

struct Body {
    std::string name;
    int axis = -1;     // that carries it; the frame of its shapes is the machine frame at 0
    bool tool = false; // carried by the spindle; the frame of its shapes has the tip as origin
    std::vector<Shape> shapes;
};

struct Setup {
    Machine machine; // the real one
    Machine assumed; // with which the samples are computed: within the stated tolerances of its
                     // axes, and wrong on purpose in one test
    bool has_tolerances = false;
    std::vector<Body> bodies;
    std::string tables; // of the set-up file
    double tool_length = 0.0;
    Joints offset{}; // G54
    Joints start{};
    bool table_only = false, turned = false; // turned: the work offset has rotary axes
    Vec middle;                              // of the fixtures, in G54
    double reach = 0.0;

    std::string letters() const { return {machine.rotary(0).letter, machine.rotary(1).letter}; }
    /// The frame of the work offset in that of the table.
    Pose work() const {
        return machine.link(machine.last_of(true), offset).inverse()
               * Pose{{}, machine.link(machine.last_of(false), offset).t};
    }
};

class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double real(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
    bool chance(double part) { return real(0.0, 1.0) < part; }
    Vec vec(double most) { return {real(-most, most), real(-most, most), real(-most, most)}; }
    Vec direction() {
        for (;;) {
            const Vec v = vec(1.0);
            if (length(v) > 0.1 && length(v) < 1.0) return unit(v);
        }
    }
    template <typename T>
    const T& of(const std::vector<T>& list) {
        return list[static_cast<size_t>(whole(0, static_cast<int>(list.size()) - 1))];
    }

private:
    std::mt19937 engine_;
};

/// A number as it is written, and its value.
double written(double value, int digits = 4) {
    return std::strtod(fmt::format("{:.{}f}", value, digits).c_str(), nullptr);
}

std::string list(const Vec& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x, v.y, v.z); }

Vec written(const Vec& v, int digits = 3) {
    return {written(v.x, digits), written(v.y, digits), written(v.z, digits)};
}

enum class Control { fanuc, haas, heidenhain, siemens, linuxcnc };
enum class Arrangement { tables, heads, mixed };

std::string name_of(Control control) {
    return std::array{"fanuc", "haas", "heidenhain", "siemens",
                      "linuxcnc"}[static_cast<size_t>(control)];
}

/// Axes with random sides, orders and directions.
Machine random_machine(Random& random, Arrangement arrangement, bool far) {
    Machine machine;
    const bool c_first = arrangement == Arrangement::heads && random.chance(0.8);
    // For tables the outer one tilts, for heads usually the inner one.
    const char tilting = random.chance(0.5) ? 'A' : 'B';
    std::vector<char> letters = {tilting, 'C'};
    if (c_first) letters = {'C', tilting};
    if (arrangement == Arrangement::heads && !c_first)
        letters = {tilting == 'A' ? 'B' : 'A', tilting};
    const double spread = far ? 300.0 : random.chance(0.3) ? 0.0 : 30.0;
    const Vec pivot =
        written(Vec{random.real(-200, 200), random.real(-200, 200), random.real(-600, -300)});
    const bool nutating = random.chance(0.3);
    std::vector<Axis> rotary;
    for (size_t i = 0; i < 2; ++i) {
        Axis axis;
        axis.letter = letters[i];
        axis.slot = 3 + static_cast<int>(i);
        axis.table = arrangement == Arrangement::tables
                     || (arrangement == Arrangement::mixed && axis.letter == 'C');
        axis.direction = axis.letter == 'A' ? along_x : axis.letter == 'B' ? along_y : along_z;
        if (nutating && axis.letter != 'C') {
            axis.direction = random.chance(0.5)
                                 ? unit(axis.letter == 'A' ? Vec{1, 0, random.real(-1.2, 1.2)}
                                                           : Vec{0, 1, random.real(-1.2, 1.2)})
                                 : unit(axis.direction + random.vec(0.5));
        } else if (random.chance(0.1)) {
            axis.direction = unit(axis.direction + random.vec(0.001)); // not quite square
        }
        if (random.chance(0.4)) axis.direction = -axis.direction;
        axis.point = axis.table ? pivot + written(random.vec(spread))
                                : written(random.vec(spread)) + Vec{0, 0, random.real(50, 250)};
        axis.point = written(axis.point);
        rotary.push_back(axis);
    }
    std::vector<Axis> linear;
    for (int i = 0; i < 3; ++i)
        linear.push_back({"XYZ"[i],
                          i,
                          random.chance(i == 2 ? 0.1 : 0.3),
                          i == 0   ? along_x
                          : i == 1 ? along_y
                                   : along_z,
                          {}});
    for (int i = 2; i > 0; --i) std::swap(linear[i], linear[random.whole(0, i)]);
    machine.axes = linear;
    machine.axes.insert(machine.axes.end(), rotary.begin(), rotary.end());
    // Now and then slides that a rotary axis carries. Where they could come to lie along others,
    // tip control has no answer.
    const std::vector<Axis> usual = machine.axes;
    if (random.chance(0.2))
        for (int attempt = 0; attempt < 20; ++attempt) {
            machine.axes = rotary;
            for (const Axis& slide : linear)
                machine.axes.insert(machine.axes.begin()
                                        + random.whole(0, static_cast<int>(machine.axes.size())),
                                    slide);
            double least = 1.0;
            for (int i = 0; i < 30; ++i) {
                const Joints at{0, 0, 0, random.real(-180, 180), random.real(-180, 180)};
                least = std::min(least, machine.volume(at));
            }
            if (least > 0.5) break;
            machine.axes = usual;
        }
    return machine;
}

Shape random_shape(Random& random, double size, const Vec& middle, bool tilted, std::string& keys) {
    const Vec turn = tilted ? written(random.vec(180.0)) : Vec{};
    const Rotation rotation = about_xyz(turn);
    const Vec spot = written(middle + random.vec(0.6 * size));
    if (tilted) keys += "rotate_deg = " + list(turn) + "\n";
    if (random.chance(0.5)) {
        const Vec half = written(
            0.5 * size * Vec{random.real(0.1, 1), random.real(0.1, 1), random.real(0.1, 1)});
        const Vec off = written(random.vec(10.0));
        keys += fmt::format("at = {}\nbox = [{}, {}]\n", list(spot), list(off - half),
                            list(off + half));
        return box_of(off - half, off + half, {rotation, spot});
    }
    const double radius = written(size * random.real(0.05, 0.4), 3),
                 height = written(size * random.real(0.1, 1.0), 3);
    const int axis = random.whole(0, 2);
    keys += fmt::format("at = {}\ncylinder = {{ radius = {}, height = {}, axis = \"{}\" }}\n",
                        list(spot), radius, height, "XYZ"[axis]);
    const Rotation lying = axis == 0   ? about(along_y, 90.0)
                           : axis == 1 ? about(along_x, -90.0)
                                       : Rotation{};
    return turned_of({{radius, 0, 0}, {radius, height, 0}}, {rotation * lying, spot});
}

/// The tool, from the tip up.
void add_tool(Random& random, Setup& setup) {
    const double diameter = written(random.real(3, 20), 2), radius = 0.5 * diameter;
    double flutes = written(random.real(radius + 1, 40), 2);
    const double shank = written(random.real(5, 50), 2), lower = written(random.real(20, 60), 2),
                 upper = written(random.chance(0.5) ? lower : random.real(30, 80), 2),
                 high = written(random.real(20, 80), 2), neck = written(random.real(2, 20), 2);
    const double narrow = written(random.chance(0.5) ? diameter : random.real(3, 20), 2);
    Body edge{"flutes", -1, true, {}};
    std::string shape = "flat", keys;
    switch (random.whole(0, 3)) {
    case 0:
        shape = "ball";
        flutes = written(std::max(flutes, diameter + 0.5), 2); // the hull is then the whole ball
        edge.shapes.push_back(turned_of({{0, radius, radius}, {radius, flutes, 0}}, {}));
        break;
    case 1: {
        const double corner = written(0.5 * radius, 3);
        shape = "bull";
        keys = fmt::format("corner_radius = {}\n", corner);
        edge.shapes.push_back(
            turned_of({{radius - corner, corner, corner}, {radius, flutes, 0}}, {}));
        break;
    }
    default:
        edge.shapes.push_back(turned_of({{radius, 0, 0}, {radius, flutes, 0}}, {}));
        break;
    }
    setup.bodies.push_back(edge);
    double z = flutes;
    setup.bodies.push_back(
        {"shank", -1, true, {turned_of({{0.5 * narrow, z, 0}, {0.5 * narrow, z + shank, 0}}, {})}});
    z += shank;
    Body holder{"holder", -1, true, {}};
    holder.shapes.push_back(turned_of({{0.5 * lower, z, 0}, {0.5 * upper, z + high, 0}}, {}));
    z += high;
    holder.shapes.push_back(
        turned_of({{0.5 * upper + 3, z, 0}, {0.5 * upper + 3, z + neck, 0}}, {}));
    z += neck;
    setup.bodies.push_back(holder);
    setup.tool_length = z;
    setup.tables += fmt::format("[[tool]]\nnumber = 1\nshape = \"{}\"\n{}diameter = "
                                "{}\nflute_length = {}\nshank = [[{}, {}, "
                                "{}]]\nholder = [[{}, {}, {}], [{}, {}, {}]]\n",
                                shape, keys, diameter, flutes, narrow, narrow, shank, lower, upper,
                                high, upper + 6, upper + 6, neck);
}

std::string axis_name(const Machine& machine, int axis) {
    return axis < 0 ? std::string("base") : std::string(1, machine.axes[axis].letter);
}

/// Moves an axis of rotation within tolerances, often to their limit, and states these.
std::string misplaced(Random& random, Machine& machine, char letter) {
    const double point = random.chance(0.3) ? 0.0 : written(random.real(0.0, 0.4), 3);
    const double turn = random.chance(0.3) ? 0.0 : written(random.real(0.0, 0.2), 3);
    const auto part = [&] { return random.chance(0.5) ? 0.9999 : random.real(0.0, 0.9999); };
    for (Axis& axis : machine.axes) {
        if (axis.letter != letter) continue;
        axis.point = axis.point + part() * point * random.direction();
        const Vec about_this = unit(cross(axis.direction, random.direction()));
        axis.direction = about(about_this, part() * turn) * axis.direction;
    }
    return fmt::format("point_tolerance = {}\ndirection_tolerance = {}\n", point, turn);
}

/// Machine, tool, fixtures near the tables' centre, bodies of the machine near them.
Setup random_setup(Random& random, Control control, Arrangement arrangement,
                   bool may_have_tolerances) {
    Setup setup;
    const bool far = random.chance(0.08);
    setup.machine = random_machine(random, arrangement, far);
    setup.table_only = arrangement == Arrangement::tables;
    const Machine& machine = setup.machine;
    setup.has_tolerances = random.chance(0.2) && !far && may_have_tolerances;
    Machine really = setup.machine;
    std::string axes;
    for (const Axis& axis : machine.axes) {
        axes += fmt::format("[[machine.axis]]\nname = \"{}\"\nside = \"{}\"\ndirection = {}\n",
                            axis.letter, axis.table ? "table" : "tool", list(axis.direction));
        if (axis.rotary()) axes += "point = " + list(axis.point) + "\n";
        if (axis.rotary() && setup.has_tolerances) axes += misplaced(random, really, axis.letter);
    }
    // The work: near the last rotary axis of the table, sometimes far from it.
    Vec centre{0, 0, -450};
    for (const Axis& axis : machine.axes)
        if (axis.rotary() && axis.table) centre = axis.point;
    const double off = far ? std::pow(10.0, random.real(2.5, 4.0)) : 60.0;
    const Vec origin = written(centre + random.vec(off));
    setup.offset = {origin.x, origin.y, origin.z, 0, 0};
    std::string turned_offset;
    if ((control == Control::fanuc || control == Control::linuxcnc) && random.chance(0.15))
        for (const Axis& axis : machine.axes)
            if (axis.rotary() && axis.table) {
                setup.offset[axis.slot] = written(random.real(-180, 180), 1);
                turned_offset += fmt::format(", {} = {}", axis.letter, setup.offset[axis.slot]);
            }
    setup.turned = !turned_offset.empty();
    setup.middle = written(random.vec(40.0));
    setup.reach = random.real(30.0, 90.0);
    const Pose work = setup.work();
    const int count = random.whole(1, 3), on_table = machine.last_of(true);
    std::string fixtures;
    for (int i = 0; i < count; ++i) {
        const bool in_machine = random.chance(0.25);
        std::string keys;
        Shape shape =
            random_shape(random, random.real(8.0, 60.0),
                         in_machine ? work * setup.middle : setup.middle, random.chance(0.6), keys);
        fixtures += fmt::format("[[fixture]]\nname = \"f{}\"\nframe = \"{}\"\n{}", i,
                                in_machine ? "machine" : "G54", keys);
        if (!in_machine) shape.place = work * shape.place;
        shape.finish();
        setup.bodies.push_back({fmt::format("f{}", i), on_table, false, {shape}});
    }
    std::string machine_bodies;
    const int more = random.whole(0, 2);
    for (int i = 0; i < more; ++i) {
        const int axis = random.whole(-1, static_cast<int>(machine.axes.size()) - 1);
        // Of the head: beside and above the gauge line; otherwise beside the work.
        const bool head = axis >= 0 && !machine.axes[axis].table;
        const Vec beside = 90.0 * random.direction();
        const Vec near = head ? Vec{0.5 * beside.x, 0.5 * beside.y, random.real(-10, 80)}
                              : work * setup.middle + beside;
        std::string keys;
        const Shape shape =
            random_shape(random, random.real(20.0, 100.0), near, random.chance(0.4), keys);
        machine_bodies += fmt::format("[[machine.body]]\nname = \"b{}\"\naxis = \"{}\"\n{}", i,
                                      axis_name(machine, axis), keys);
        setup.bodies.push_back({fmt::format("b{}", i), axis, false, {shape}});
    }
    const Vec above = origin + Vec{0, 0, 300};
    for (int i = 0; i < 3; ++i) setup.start[i] = written((&above.x)[i], 3);
    std::string start =
        fmt::format("{{ X = {}, Y = {}, Z = {}, {} = 0, {} = 0 }}", setup.start[0], setup.start[1],
                    setup.start[2], machine.rotary(0).letter, machine.rotary(1).letter);
    std::string tool;
    std::swap(tool, setup.tables);
    add_tool(random, setup);
    std::swap(tool, setup.tables);
    std::string control_keys;
    if (control == Control::fanuc)
        control_keys = "\"5006#6\" = 1\n\"1008#0\" = 0\n\"5001#6\" = 0\n";
    if (control == Control::siemens)
        control_keys = "MD10602 = 1\nMD22550 = 1\nMD20270 = 1\nMD21104 = 0\nORIWKS = \"plane\"\n";
    if (control == Control::linuxcnc) control_keys = "M428 = \"TCP\"\n";
    // With 0, contact while the rotary axes turn takes Feeler seconds.
    const double allowance = random.chance(0.02) ? 0.0 : written(random.real(0.2, 3.0), 2);
    setup.tables = fmt::format(
        "mesh_size = 5\nallowance = {}\n[program]\ndialect = \"{}\"\nstart = {}\n{}[control]\n{}"
        "[machine]\nrapid = \"straight\"\n{}{}[stock]\nbox = [[-90000, -90000, 0], [-89990, "
        "-89990, 10]]\nframe = \"machine\"\n[offsets]\nG54 = {{ X = {}, Y = {}, Z = {}{} }}\n{}{}",
        allowance, name_of(control), start,
        control == Control::fanuc || control == Control::haas ? "no_decimal_point = \"units\"\n"
                                                              : "",
        control_keys, axes, machine_bodies, origin.x, origin.y, origin.z, turned_offset, fixtures,
        tool);
    setup.assumed = really;
    return setup;
}

// ---------------------------------------------------------------------------------------------
// Distances along a path.

struct Path {
    std::string kind;
    std::function<Joints(double)> at; // from 0 to 1
    bool may_be_doubtful = false;     // Feeler may say that the control may go another way
};

class Sampler {
public:
    Sampler(const Setup& setup) : setup_(setup) {}

    Pose place(const Body& body, const Joints& at) const {
        return place(body, at, setup_.assumed.turns(at));
    }
    Pose place(const Body& body, const Joints& at, const Machine::Turns& turns) const {
        const Machine& machine = setup_.assumed;
        Pose pose = machine.link(body.tool ? machine.last_of(false) : body.axis, at, turns);
        if (body.tool) pose.t = pose.t - setup_.tool_length * (pose.r * along_z);
        return pose;
    }
    Pose relative(const Body& a, const Body& b, const Joints& at) const {
        const Machine::Turns turns = setup_.assumed.turns(at);
        return place(b, at, turns).inverse() * place(a, at, turns);
    }
    const Body* find(const std::string& name) const {
        for (const Body& body : setup_.bodies)
            if (body.name == name) return &body;
        return nullptr;
    }
    /// The least distance at some samples, not beyond `limit`.
    double coarse(const Path& path, double limit) const {
        double least = limit;
        for (int i = 0; i <= 12; ++i) {
            const Joints at = path.at(i / 12.0);
            for (const Body& a : setup_.bodies) {
                if (!a.tool) continue;
                const Pose of_a = place(a, at);
                for (const Body& b : setup_.bodies) {
                    if (b.name[0] != 'f') continue;
                    const Pose relative = place(b, at).inverse() * of_a;
                    least = std::min(least, distance(a, b, relative, least));
                }
            }
        }
        return least;
    }
    static double distance(const Body& a, const Body& b, const Pose& relative, double limit) {
        double least = limit;
        for (const Shape& p : a.shapes)
            for (const Shape& q : b.shapes) {
                if (length(relative * p.centre - q.centre) - p.around - q.around >= least) continue;
                Vec from;
                least = std::min(least, gap_of(p, q, relative, from).most);
            }
        return least;
    }

    struct Least {
        double sampled = endless; // of points that exist
        double certain = endless; // the minimum is not less, if the path is as smooth as it looks
        double at = 0.0;
        int tests = 0;
        double certain_so_far(double bound) const { return std::min(certain, bound); }
        double reported = endless; // a lower bound: beyond it nothing matters
    };

    /// Of a pair along a path; distances beyond `limit` do not matter.
    Least least(const Body& a, const Body& b, const Path& path, double limit, double fine,
                double reported = endless) {
        Least all;
        all.reported = reported;
        all.certain = all.sampled = limit;
        constexpr int cells = 48;
        if (nodes_.empty() || node_path_ != &path) {
            nodes_.clear();
            turns_.clear();
            for (int i = 0; i <= cells; ++i) {
                nodes_.push_back(path.at(double(i) / cells));
                turns_.push_back(setup_.assumed.turns(nodes_.back()));
            }
            node_path_ = &path;
        }
        std::vector<Pose> relative;
        for (size_t i = 0; i < nodes_.size(); ++i)
            relative.push_back(place(b, nodes_[i], turns_[i]).inverse()
                               * place(a, nodes_[i], turns_[i]));
        for (const Shape& p : a.shapes)
            for (const Shape& q : b.shapes) piece(a, b, p, q, path, relative, fine, all);
        return all;
    }

private:
    void piece(const Body& a, const Body& b, const Shape& p, const Shape& q, const Path& path,
               const std::vector<Pose>& relative, double fine, Least& all) {
        const int cells = static_cast<int>(relative.size()) - 1;
        // How far any point of A moves in the frame of B from node to node.
        std::vector<double> moved(cells);
        std::vector<double> ball(cells + 1);
        for (int i = 0; i <= cells; ++i) {
            ball[i] = length(relative[i] * p.centre - q.centre) - p.around - q.around;
            if (i == 0) continue;
            const Rotation &r = relative[i].r, &s = relative[i - 1].r;
            const double turned =
                dot(r.x - s.x, r.x - s.x) + dot(r.y - s.y, r.y - s.y) + dot(r.z - s.z, r.z - s.z);
            moved[i - 1] = length(relative[i] * p.centre - relative[i - 1] * p.centre)
                           + p.around * std::sqrt(0.5 * turned);
        }
        struct Cell {
            double bound, begin, end, speed, at_begin, at_end;
            bool operator<(const Cell& other) const { return bound > other.bound; }
        };
        std::priority_queue<Cell> open;
        Vec from;
        const auto measure = [&](const Pose& pose, double s) {
            const Gap gap = gap_of(p, q, pose, from);
            ++all.tests;
            if (gap.most < all.sampled) all.sampled = gap.most, all.at = s;
            return gap.least;
        };
        std::vector<double> known(cells + 1, -1.0);
        const auto at_node = [&](int i) {
            if (known[i] < 0.0) known[i] = measure(relative[i], double(i) / cells);
            return known[i];
        };
        // The nearest node first, for a good limit.
        const int nearest =
            static_cast<int>(std::min_element(ball.begin(), ball.end()) - ball.begin());
        if (ball[nearest] < all.sampled) at_node(nearest);
        for (int i = 0; i < cells; ++i) {
            double most = moved[i];
            if (i > 0) most = std::max(most, moved[i - 1]);
            if (i + 1 < cells) most = std::max(most, moved[i + 1]);
            const double way = 1.3 * most + 1e-9;
            double bound = 0.5 * (ball[i] + ball[i + 1] - way);
            if (bound < all.sampled) bound = 0.5 * (at_node(i) + at_node(i + 1) - way);
            if (bound < all.sampled)
                open.push({bound, double(i) / cells, double(i + 1) / cells, way * cells, known[i],
                           known[i + 1]});
        }
        double least_bound = endless;
        double width = 1.0 / cells;
        while (!open.empty()) {
            const Cell cell = open.top();
            if (cell.bound >= std::min(all.sampled - fine, all.reported) || all.tests > 20000) {
                least_bound = cell.bound;
                break;
            }
            open.pop();
            const double middle = 0.5 * (cell.begin + cell.end);
            const Joints at = path.at(middle);
            const double before = all.sampled;
            const double here = measure(this->relative(a, b, at), middle);
            const double half = 0.5 * (cell.end - cell.begin);
            if (all.sampled < before) width = half;
            const auto add = [&](double begin, double end, double x, double y) {
                const double bound = 0.5 * (x + y - cell.speed * (end - begin));
                if (bound < all.sampled)
                    open.push({bound, begin, end, cell.speed, x, y});
                else
                    least_bound = std::min(least_bound, bound);
            };
            add(cell.begin, middle, cell.at_begin, here);
            add(middle, cell.end, here, cell.at_end);
        }
        // Golden section around the best sample.
        if (all.sampled > 0.0 && all.sampled < search_limit) {
            const auto value = [&](double s) {
                const Joints at = path.at(s);
                const double before = all.sampled;
                const Gap gap = gap_of(p, q, this->relative(a, b, at), from);
                if (gap.most < before) all.sampled = gap.most, all.at = s;
                return gap.most;
            };
            constexpr double golden = 0.6180339887498949;
            double low = std::max(0.0, all.at - width), high = std::min(1.0, all.at + width);
            double s = high - golden * (high - low), t = low + golden * (high - low);
            double at_s = value(s), at_t = value(t);
            const int steps = all.certain_so_far(least_bound) >= all.reported ? 12 : 36;
            for (int i = 0; i < steps; ++i) {
                if (at_s < at_t) {
                    high = t, t = s, at_t = at_s;
                    s = high - golden * (high - low), at_s = value(s);
                } else {
                    low = s, s = t, at_s = at_t;
                    t = low + golden * (high - low), at_t = value(t);
                }
            }
        }
        all.certain = std::min({all.certain, least_bound, all.sampled});
    }

    const Setup& setup_;
    std::vector<Joints> nodes_;
    std::vector<Machine::Turns> turns_;
    const Path* node_path_ = nullptr;
};

// ---------------------------------------------------------------------------------------------
// Programs.

struct Line {
    std::string text;
    std::optional<Path> path; // of a line that moves
};

/// The frame of the program's coordinates in that of the table. A work offset of a rotary axis
/// turns it, except on LinuxCNC, whose kinematics know the positions of the joints alone.
Pose program_frame(Setup setup, Control control) {
    if (control == Control::linuxcnc) setup.offset[3] = setup.offset[4] = 0.0;
    return setup.work();
}

/// Writes lines and knows where they take the axes.
class Writer {
public:
    Writer(Random& random, const Setup& setup, Control control)
        : random_(random),
          setup_(setup),
          machine_(setup.machine),
          control_(control),
          sampler_(setup),
          at_(setup.start),
          work_(program_frame(setup, control)) {}

    std::vector<Line> lines;

    void say(const std::string& text) { lines.push_back({text, {}}); }
    int moves() const { return moves_; }

    void write_program(int blocks);

private:
    enum class Mode { joints, tip, plane, shifted };

    // Targets.
    struct Target {
        Vec tip; // in the program's coordinates
        double first = 0.0, second = 0.0;
    };

    bool klartext() const { return control_ == Control::heidenhain; }
    std::string word(char letter, double value, int digits = 4) const {
        return fmt::format(" {}{}{:.{}f}", letter, klartext() && value >= 0.0 ? "+" : "", value,
                           digits);
    }
    std::string xyz(const Vec& v) const { return word('X', v.x) + word('Y', v.y) + word('Z', v.z); }
    std::string rotary(const Target& t) const {
        return word(machine_.rotary(0).letter, t.first - setup_.offset[3])
               + word(machine_.rotary(1).letter, t.second - setup_.offset[4]);
    }

    /// The programmed position of the axes; in a plane or with tip control that of the tip.
    Vec programmed(Mode mode, const Joints& at) const {
        if (mode == Mode::joints)
            return {at[0] - setup_.offset[0], at[1] - setup_.offset[1],
                    at[2] - setup_.offset[2] - setup_.tool_length};
        const Vec tip = machine_.tool_in_table(at) * Vec{0, 0, -setup_.tool_length};
        if (mode == Mode::shifted) {
            const Pose table = machine_.link(machine_.last_of(true), at);
            return table * tip - table * work_.t;
        }
        return (work_ * plane_).inverse() * tip;
    }
    Joints joints_of(Mode mode, const Target& t) const {
        Joints at = at_;
        at[3] = t.first, at[4] = t.second;
        if (mode == Mode::joints) {
            at[0] = setup_.offset[0] + t.tip.x, at[1] = setup_.offset[1] + t.tip.y;
            at[2] = setup_.offset[2] + t.tip.z + setup_.tool_length;
            return at;
        }
        if (mode == Mode::shifted) {
            const Pose table = machine_.link(machine_.last_of(true), at);
            machine_.reach(at, setup_.tool_length, table.inverse() * (table * work_.t + t.tip));
            return at;
        }
        machine_.reach(at, setup_.tool_length, work_ * (plane_ * t.tip));
        return at;
    }
    Target now(Mode mode) const { return {programmed(mode, at_), at_[3], at_[4]}; }

    Path straight_joints(const Joints& to, const std::string& kind) const {
        const Joints from = at_;
        return {kind, [from, to](double s) {
                    Joints at;
                    for (int i = 0; i < 5; ++i) at[i] = from[i] + s * (to[i] - from[i]);
                    return at;
                }};
    }
    /// The point `below` the gauge line goes along `tip(s)` in the table's frame while the rotary
    /// axes turn evenly.
    Path tip_path(const std::function<Vec(double)>& tip, double first, double second, double below,
                  const std::string& kind) const {
        const Joints from = at_;
        const Machine* machine = &machine_;
        return {kind, [=](double s) {
                    Joints at = from;
                    at[3] = from[3] + s * (first - from[3]);
                    at[4] = from[4] + s * (second - from[4]);
                    machine->reach(at, below, tip(s));
                    return at;
                }};
    }
    Vec tip_now(double below) const { return machine_.tool_in_table(at_) * Vec{0, 0, -below}; }

    Path straight_to(Mode mode, const Target& t, const std::string& kind) const {
        if (mode == Mode::joints || mode == Mode::shifted)
            return straight_joints(joints_of(mode, t), kind);
        const Vec from = tip_now(setup_.tool_length), to = work_ * (plane_ * t.tip);
        return tip_path([=](double s) { return from + s * (to - from); }, t.first, t.second,
                        setup_.tool_length, kind);
    }

    void add(const std::string& text, Path path) {
        at_ = path.at(1.0);
        lines.push_back({text, std::move(path)});
        ++moves_;
    }
    /// The feed at the end of a straight move, and its beginning.
    std::string straight_text(const std::string& words, bool rapid) {
        const double feed = written(random_.real(200, 3000), 0);
        if (klartext())
            return fmt::format("L{} R0 {}", words,
                               rapid ? std::string("FMAX") : fmt::format("F{:.0f}", feed));
        if (rapid) return "G0" + words;
        if (inverse_time_) return fmt::format("G1{} F{:.2f}", words, random_.real(1, 60));
        return fmt::format("G1{} F{:.0f}", words, feed);
    }

    Target random_target(Mode mode, bool turns, const Target& before);
    void random_move(Mode mode, bool turns, bool all_words, const std::string& kind);
    void random_arc(Mode mode, bool turns, const std::string& kind);
    void moves_in(Mode mode, bool turns, int count, const std::string& kind);
    void section(int count);
    void plane_section(int count);
    bool vector_move(const std::string& kind, bool in_plane);
    Path plane_turn(const Target& t, bool& good, const std::string& kind) const;
    std::optional<std::array<double, 2>> chosen(const Vec& towards, int sign) const;
    const Axis& tilting() const;

    Random& random_;
    const Setup& setup_;
    const Machine& machine_;
    Control control_;
    Sampler sampler_;
    Joints at_;
    Pose work_;
    Pose plane_; // of the tilted plane, in the work offset
    bool inverse_time_ = false;
    int moves_ = 0;
};

/// A target of a random size of move.
Writer::Target Writer::random_target(Mode mode, bool turns, const Target& before) {
    Target t = before;
    const auto anywhere = [&] {
        // Where the tip is to be in the work; the program's coordinates follow from the mode.
        Vec work = setup_.middle + random_.vec(setup_.reach);
        if (random_.chance(0.01)) work = work + random_.vec(1e4);
        if (mode == Mode::tip || mode == Mode::plane) return plane_.inverse() * work;
        Joints at = at_;
        at[3] = t.first, at[4] = t.second;
        machine_.reach(at, setup_.tool_length, work_ * work);
        return programmed(mode, at);
    };
    const auto turn = [&](double most) {
        if (!turns) return;
        if (random_.chance(0.85)) t.first += random_.real(-most, most);
        if (random_.chance(0.85)) t.second += random_.real(-most, most);
    };
    switch (random_.whole(0, 9)) {
    case 0: // tiny
        t.tip = t.tip + random_.vec(0.01);
        turn(0.01);
        break;
    case 1: // pure turn
        turn(random_.chance(0.5) ? 20.0 : 180.0);
        break;
    case 2: // no turn
        t.tip = anywhere();
        break;
    case 3:
    case 4: // small
        t.tip = t.tip + random_.vec(10.0);
        turn(5.0);
        break;
    case 5: // through or to a singular position
        if (turns) {
            const bool ends = random_.chance(0.5);
            t.first = ends ? 0.0 : -t.first;
            if (random_.chance(0.5)) t.second += random_.real(-180.0, 180.0);
            if (machine_.rotary(0).letter == 'C') std::swap(t.first, t.second);
        }
        t.tip = random_.chance(0.5) ? anywhere() : t.tip;
        break;
    case 6: // large
        if (turns) {
            t.first = random_.real(-180.0, 180.0);
            t.second = random_.real(-180.0, 180.0);
        }
        t.tip = anywhere();
        break;
    default:
        turn(60.0);
        t.tip = anywhere();
        break;
    }
    if (turns && std::abs(t.first) > 400.0) t.first = 10.0;
    if (turns && std::abs(t.second) > 400.0) t.second = 10.0;
    t.tip = {written(t.tip.x), written(t.tip.y), written(t.tip.z)};
    if (turns) t.first = written(t.first), t.second = written(t.second);
    return t;
}

/// A straight move near the fixtures; mostly one that does not collide.
void Writer::random_move(Mode mode, bool turns, bool all_words, const std::string& kind) {
    const Target before = now(mode);
    std::optional<Target> best;
    double best_merit = -1.0;
    const bool any = random_.chance(0.015);
    for (int attempt = 0; attempt < 10; ++attempt) {
        const Target t = random_target(mode, turns, before);
        if (any) {
            best = t;
            break;
        }
        const double gap = sampler_.coarse(straight_to(mode, t, kind), 100.0);
        const double merit = gap <= 0.01 ? 0.0 : gap < 45.0 ? 2.0 : 1.0;
        if (merit <= best_merit) continue;
        best = t, best_merit = merit;
        if (merit > 1.5) break;
    }
    Target t = *best;
    std::string words;
    bool some = false;
    for (int i = 0; i < 3; ++i) {
        double& to = (&t.tip.x)[i];
        const double was = (&before.tip.x)[i];
        if (!all_words && (random_.chance(0.15) || std::abs(to - was) < 1e-7)) {
            to = was;
            continue;
        }
        words += word("XYZ"[i], to);
        some = true;
    }
    if (turns)
        for (int i = 0; i < 2; ++i) {
            double& to = i == 0 ? t.first : t.second;
            const double was = at_[3 + i];
            if (!all_words && (random_.chance(0.15) || to == was)) {
                to = was;
                continue;
            }
            words += word(machine_.rotary(i).letter, to - setup_.offset[3 + i]);
            some = true;
        }
    if (!some) return;
    const bool rapid = random_.chance(0.4);
    add(straight_text(words, rapid), straight_to(mode, t, kind));
}

/// Quarters of circles in the XY plane, whose centres and ends are exact decimals.
void Writer::random_arc(Mode mode, bool turns, const std::string& kind) {
    Target before = now(mode);
    // The start must be a decimal.
    const Vec start = {written(before.tip.x), written(before.tip.y), written(before.tip.z)};
    if (length(start - before.tip) > 1e-7) return;
    const double i = written(random_.real(-30, 30), 3), j = written(random_.real(-30, 30), 3);
    if (std::hypot(i, j) < 0.5) return;
    const int quarters = random_.whole(1, 4);
    const bool clockwise = random_.chance(0.5);
    const double rise = random_.chance(0.3) ? written(random_.real(-10, 10), 3) : 0.0;
    const Vec centre = start + Vec{i, j, 0};
    double ex = -i, ey = -j;
    for (int k = 0; k < quarters; ++k) {
        const double x = ex;
        ex = clockwise ? ey : -ey;
        ey = clockwise ? -x : x;
    }
    Target t = before;
    t.tip = {written(centre.x + ex), written(centre.y + ey), written(start.z + rise)};
    if (turns) {
        t.first = written(t.first + random_.real(-20, 20));
        t.second = written(t.second + random_.real(-20, 20));
    }
    const double sweep = (clockwise ? -90.0 : 90.0) * quarters;
    const auto in_program = [=](double s) {
        const Vec arm = about(along_z, s * sweep) * Vec{-i, -j, 0};
        return Vec{centre.x + arm.x, centre.y + arm.y, start.z + s * (t.tip.z - start.z)};
    };
    Path path;
    if (mode == Mode::tip || mode == Mode::plane) {
        const Pose frame = work_ * plane_;
        path = tip_path([=](double s) { return frame * in_program(s); }, t.first, t.second,
                        setup_.tool_length, kind);
    } else {
        const Joints from = at_;
        path = {kind, [=](double s) {
                    Joints at = from;
                    const Vec by = in_program(s) - start;
                    at[0] += by.x, at[1] += by.y, at[2] += by.z;
                    return at;
                }};
    }
    if (sampler_.coarse(path, 100.0) <= 0.01 && !random_.chance(0.05)) return;
    if (klartext()) {
        say("CC" + word('X', centre.x) + word('Y', centre.y));
        if (rise != 0.0 || turns || quarters == 4) return; // C is flat; full circles need C
        add(fmt::format("C{}{} DR{} R0 F{:.0f}", word('X', t.tip.x), word('Y', t.tip.y),
                        clockwise ? '-' : '+', random_.real(200, 3000)),
            std::move(path));
        return;
    }
    std::string words = word('X', t.tip.x) + word('Y', t.tip.y);
    if (rise != 0.0) words += word('Z', t.tip.z);
    if (turns) words += rotary(t);
    add(fmt::format("{}{}{}{} F{:.0f}", clockwise ? "G2" : "G3", words, word('I', i), word('J', j),
                    random_.real(200, 3000)),
        std::move(path));
}

void Writer::moves_in(Mode mode, bool turns, int count, const std::string& kind) {
    random_move(mode, turns, true, kind);
    for (int i = 0; i < count; ++i) {
        if (!turns && !inverse_time_ && random_.chance(0.2))
            random_arc(mode, false, kind + " arc");
        else
            random_move(mode, turns, random_.chance(0.3), kind);
    }
}

/// The axis whose sign chooses the solution: of the table, that nearest to the base, or else of
/// the head, that nearest to the tool.
const Axis& Writer::tilting() const {
    const auto tilts = [](const Axis& axis) {
        return axis.rotary() && std::abs(axis.direction.z) < 1.0 - 1e-9;
    };
    const Axis* found = nullptr;
    for (const Axis& axis : machine_.axes)
        if (tilts(axis) && axis.table) return axis;
    for (const Axis& axis : machine_.axes)
        if (tilts(axis)) found = &axis;
    return *found;
}

/// Rotary positions for a direction: the nearest, or those with a sign of the tilting axis. None if
/// it is not clear which.
std::optional<std::array<double, 2>> Writer::chosen(const Vec& towards, int sign) const {
    auto found = machine_.solve(towards, 1.0);
    std::optional<std::array<double, 2>> best;
    double best_way = endless, second_way = endless;
    for (auto angles : found) {
        for (int i = 0; i < 2; ++i) angles[i] = nearest_turn(angles[i], at_[3 + i]);
        const double tilt = std::remainder(angles[tilting().slot - 3], 360.0);
        if (std::abs(tilt) < 1.0 || std::abs(tilt) > 179.0) return {};
        // Where the axis has turned beyond half a turn, its sign says nothing.
        if (sign != 0 && std::abs(angles[tilting().slot - 3]) > 179.0) return {};
        if (sign != 0 && (tilt > 0.0) != (sign > 0)) continue;
        const double way = std::abs(angles[0] - at_[3]) + std::abs(angles[1] - at_[4]);
        for (int i = 0; i < 2; ++i)
            if (std::abs(std::abs(angles[i] - at_[3 + i]) - 180.0) < 1.0) return {};
        if (way < best_way)
            second_way = best_way, best_way = way, best = angles;
        else
            second_way = std::min(second_way, way);
    }
    if (second_way - best_way < 1.0) return {};
    return best;
}

/// The tool turns evenly in the plane of its directions, and the tip goes straight.
Path Writer::plane_turn(const Target& t, bool& good, const std::string& kind) const {
    good = false;
    Joints to = at_;
    to[3] = t.first, to[4] = t.second;
    const Vec d0 = machine_.direction(at_), d1 = machine_.direction(to);
    const double angle = std::atan2(length(cross(d0, d1)), dot(d0, d1)) / degree;
    if (angle > 170.0) return {};
    const Joints from = at_;
    const Machine* machine = &machine_;
    const auto starts = machine_.solve(d0, 1e-3);
    int branch = -1;
    for (size_t i = 0; i < starts.size(); ++i) {
        double off = 0.0;
        for (int k = 0; k < 2; ++k)
            off += std::abs(nearest_turn(starts[i][k], at_[3 + k]) - at_[3 + k]);
        if (off < 1e-6) branch = static_cast<int>(i);
    }
    if (branch < 0) return {};
    const Vec side = angle < 1e-9 ? Vec{1, 0, 0} : unit(cross(d0, d1));
    const auto turned = [=](double s) {
        Joints at = from;
        if (angle < 1e-9) return at;
        const auto found = machine->solve(about(side, s * angle) * d0, 1e-6);
        if (found.size() < 2) return at; // a pole: the caller has looked for them
        for (int k = 0; k < 2; ++k) at[3 + k] = nearest_turn(found[branch][k], from[3 + k]);
        return at;
    };
    // Away from poles, and to the positions that were asked for.
    for (int i = 0; i <= 200; ++i)
        if (angle >= 1e-9 && machine_.solve(about(side, angle * i / 200.0) * d0, 2.5).empty())
            return {};
    const Joints end = turned(1.0);
    if (std::abs(end[3] - t.first) + std::abs(end[4] - t.second) > 1e-6) return {};
    for (int k = 0; k < 2; ++k)
        if (std::abs(end[3 + k] - from[3 + k]) > 170.0) return {};
    good = true;
    const Vec tip0 = tip_now(setup_.tool_length), tip1 = work_ * (plane_ * t.tip);
    const double below = setup_.tool_length;
    Path path{kind, [=](double s) {
                  Joints at = turned(s);
                  machine->reach(at, below, tip0 + s * (tip1 - tip0));
                  return at;
              }};
    path.may_be_doubtful = true;
    return path;
}

/// A move whose tool direction is a vector: G43.5, LN with TX, A3=.
bool Writer::vector_move(const std::string& kind, bool in_plane) {
    const Target before = now(Mode::tip);
    for (int attempt = 0; attempt < 20; ++attempt) {
        Target t = random_target(Mode::tip, true, before);
        Joints aim = at_;
        aim[3] = t.first, aim[4] = t.second;
        Vec d = machine_.direction(aim);
        d = {written(d.x, 9), written(d.y, 9), written(d.z, 9)};
        if (length(d) < 0.5) continue;
        Path path;
        if (in_plane) {
            // The solution is that on the way, so its branch is that of the start.
            const Vec d0 = machine_.direction(at_);
            const auto starts = machine_.solve(d0, 2.5), ends = machine_.solve(unit(d), 2.5);
            if (starts.size() < 2 || ends.size() < 2) continue;
            int branch = -1;
            for (int i = 0; i < 2; ++i) {
                double off = 0.0;
                for (int k = 0; k < 2; ++k)
                    off += std::abs(nearest_turn(starts[i][k], at_[3 + k]) - at_[3 + k]);
                if (off < 1e-6) branch = i;
            }
            if (branch < 0) continue;
            t.first = nearest_turn(ends[branch][0], at_[3]);
            t.second = nearest_turn(ends[branch][1], at_[4]);
            bool good = false;
            path = plane_turn(t, good, kind);
            if (!good) continue;
        } else {
            const auto angles = chosen(unit(d), 0);
            if (!angles) continue;
            t.first = (*angles)[0], t.second = (*angles)[1];
            path = straight_to(Mode::tip, t, kind);
        }
        if (attempt < 15 && sampler_.coarse(path, 100.0) <= 0.01) continue;
        std::string text;
        const bool rapid = random_.chance(0.3);
        if (control_ == Control::fanuc) {
            text = straight_text(
                xyz(t.tip) + word('I', d.x, 9) + word('J', d.y, 9) + word('K', d.z, 9), rapid);
        } else if (control_ == Control::siemens) {
            text = straight_text(
                fmt::format("{} A3={:.9f} B3={:.9f} C3={:.9f}", xyz(t.tip), d.x, d.y, d.z), rapid);
        } else {
            text = fmt::format("LN{} TX{:+.9f} TY{:+.9f} TZ{:+.9f} R0 F{:.0f}", xyz(t.tip), d.x,
                               d.y, d.z, random_.real(200, 3000));
        }
        add(text, std::move(path));
        return true;
    }
    return false;
}

/// A tilted plane with moves in it.
void Writer::plane_section(int count) {
    for (int attempt = 0; attempt < 50; ++attempt) {
        const Vec origin = written(setup_.middle + random_.vec(20.0), 4);
        Vec angles = written(random_.vec(random_.chance(0.5) ? 60.0 : 180.0), 4);
        Rotation r;
        std::string words;
        int sign = 0;
        const int form = random_.whole(0, 3);
        bool keeps_tip = false;
        double below = 0.0;
        std::string after_words;
        const auto rolled = [&](const std::string& order) {
            // About fixed axes, in this order.
            Rotation rotation;
            for (const char digit : order) {
                const int axis = digit - '1';
                rotation = about(axis == 0   ? along_x
                                 : axis == 1 ? along_y
                                             : along_z,
                                 (&angles.x)[axis])
                           * rotation;
            }
            return rotation;
        };
        const std::string order =
            random_.of(std::vector<std::string>{"123", "132", "213", "231", "312", "321"});
        Vec shift_after;
        if (control_ == Control::fanuc || control_ == Control::haas) {
            const std::string place = xyz(origin);
            const std::string ijk = word('I', angles.x) + word('J', angles.y) + word('K', angles.z);
            if (control_ == Control::haas) {
                words = "G268" + place + ijk + " Q" + order;
                r = rolled(order);
            } else if (form == 0) {
                words = "G68.2 P1" + place + ijk + " Q" + order;
                r = rolled(order);
            } else {
                words = "G68.2" + place + ijk;
                r = about(along_z, angles.x) * about(along_x, angles.y) * about(along_z, angles.z);
            }
            keeps_tip = control_ == Control::fanuc && random_.chance(0.3);
            plane_ = {r, origin};
        } else if (klartext()) {
            const std::string how = random_.of(std::vector<std::string>{"TURN", "MOVE", "STAY"});
            if (how != "STAY" && random_.chance(0.4)) sign = random_.chance(0.5) ? 1 : -1;
            if (form == 0) {
                words = fmt::format("PLANE EULER EULPR{:+.4f} EULNU{:+.4f} EULROT{:+.4f}", angles.x,
                                    angles.y, angles.z);
                angles.y = written(std::abs(angles.y), 4);
                words = fmt::format("PLANE EULER EULPR{:+.4f} EULNU{:+.4f} EULROT{:+.4f}", angles.x,
                                    angles.y, angles.z);
                r = about(along_z, angles.x) * about(along_x, angles.y) * about(along_z, angles.z);
            } else {
                words = fmt::format("PLANE SPATIAL SPA{:+.4f} SPB{:+.4f} SPC{:+.4f}", angles.x,
                                    angles.y, angles.z);
                r = about_xyz(angles);
            }
            plane_ = {r, {}};
            if (how == "STAY") {
                words += " STAY";
                after_words = "stay";
            } else {
                if (how == "MOVE") {
                    keeps_tip = true;
                    below = random_.chance(0.5) ? written(random_.real(0, 80), 3) : 0.0;
                    words += fmt::format(" MOVE DIST{:.3f} FMAX", below);
                } else {
                    words += " TURN FMAX";
                }
                if (sign != 0) words += sign > 0 ? " SEQ+" : " SEQ-";
            }
        } else if (control_ == Control::siemens) {
            sign = random_.chance(0.5) ? 1 : -1;
            shift_after = random_.chance(0.5) ? written(random_.vec(20.0), 4) : Vec{};
            keeps_tip = random_.chance(0.3);
            struct Coding {
                int number;
                const char* order;
            };
            static constexpr Coding codings[] = {{57, "123"}, {54, "213"}, {39, "312"},
                                                 {27, "321"}, {45, "132"}, {30, "231"}};
            int mode = 64;
            Vec as_written = angles;
            if (form == 0) {
                r = about(along_z, angles.x) * about(along_y, angles.y);
                as_written.z = 0.0;
            } else {
                const Coding& coding = codings[random_.whole(0, 5)];
                mode = coding.number;
                // About the axes as they have been turned: A, B and C are the first, second and
                // third turn.
                for (int k = 0; k < 3; ++k) {
                    const int axis = coding.order[k] - '1';
                    r = r
                        * about(axis == 0   ? along_x
                                : axis == 1 ? along_y
                                            : along_z,
                                (&as_written.x)[k]);
                }
            }
            words = fmt::format(
                "CYCLE800(0,\"T\",{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},"
                "{:.4f},{},100,1)",
                keeps_tip ? 10 : 0, mode, origin.x, origin.y, origin.z, as_written.x, as_written.y,
                as_written.z, shift_after.x, shift_after.y, shift_after.z, sign);
            plane_ = Pose{r, origin} * Pose{{}, shift_after};
        } else {
            return;
        }
        const auto rotary_to = chosen(r * along_z, sign);
        if (!rotary_to) {
            plane_ = {};
            continue;
        }
        Target turn{{}, (*rotary_to)[0], (*rotary_to)[1]};
        Joints there = at_;
        there[3] = turn.first, there[4] = turn.second;
        const Vec kept = tip_now(setup_.tool_length + below);
        Path path = keeps_tip ? tip_path([=](double) { return kept; }, turn.first, turn.second,
                                         setup_.tool_length + below, "plane turn")
                              : straight_joints(there, "plane turn");
        if (control_ == Control::fanuc || control_ == Control::haas) {
            say(words);
            add(control_ == Control::haas ? "G253"
                : keeps_tip               ? "G53.6"
                                          : "G53.1",
                std::move(path));
        } else if (after_words == "stay") {
            say(words);
            std::string go = "L";
            for (int i = 0; i < 2; ++i) {
                const char letter = machine_.rotary(i).letter;
                go += fmt::format(" {}+Q{}", letter, 120 + letter - 'A');
            }
            add(go + " R0 FMAX", std::move(path));
        } else {
            add(words, std::move(path));
        }
        moves_in(Mode::plane, false, count, "plane");
        plane_ = {};
        switch (control_) {
        case Control::fanuc:
            say("G69");
            break;
        case Control::haas:
            say("G269");
            break;
        case Control::heidenhain:
            say("PLANE RESET STAY");
            break;
        default:
            say("CYCLE800()");
            break;
        }
        return;
    }
}

void Writer::section(int count) {
    const auto joints = [&] {
        if (control_ != Control::heidenhain && control_ != Control::siemens) say("G43 H1");
        inverse_time_ = control_ != Control::heidenhain && random_.chance(0.3);
        if (inverse_time_) say("G93");
        moves_in(Mode::joints, true, count, inverse_time_ ? "joints G93" : "joints");
        if (!inverse_time_ && random_.chance(0.3))
            for (int i = 0; i < 3; ++i) random_arc(Mode::joints, false, "joints arc");
        if (inverse_time_) say("G94");
        inverse_time_ = false;
    };
    const auto tip = [&](const std::string& on, const std::string& off, const std::string& kind) {
        say(on);
        inverse_time_ = control_ != Control::heidenhain && random_.chance(0.2);
        if (inverse_time_) say("G93");
        moves_in(Mode::tip, true, count, kind);
        if (!inverse_time_)
            for (int i = 0; i < 3; ++i) {
                random_move(Mode::tip, true, true, kind);
                random_arc(Mode::tip, control_ == Control::fanuc && random_.chance(0.3),
                           kind + " arc");
            }
        if (inverse_time_) say("G94");
        inverse_time_ = false;
        say(off);
    };
    // A tilted plane with such an offset is refused, and vectors are rare with it.
    const int what = random_.whole(0, setup_.turned ? 1 : 3);
    switch (control_) {
    case Control::fanuc:
        if (what == 0) return joints();
        if (what == 1) return tip("G43.4 H1", "G49", "G43.4");
        if (what == 2) {
            say("G43 H1");
            random_move(Mode::joints, true, true, "joints");
            return plane_section(count);
        }
        say("G43.5 H1");
        for (int i = 0; i < count; ++i) vector_move("G43.5", false);
        say("G49");
        return;
    case Control::haas:
        if (what == 0) return joints();
        if (what == 1) return tip("G234 H1", "G49", "G234");
        if (what == 3 && setup_.table_only) {
            say("G43 H1");
            random_move(Mode::joints, true, true, "joints");
            say("G254");
            moves_in(Mode::shifted, false, count, "G254");
            say("G255");
            return;
        }
        say("G43 H1");
        random_move(Mode::joints, true, true, "joints");
        return plane_section(count);
    case Control::linuxcnc:
        if (what == 0) return joints();
        say("G43 H1");
        return tip("M428", "M429", "M428");
    case Control::heidenhain:
        if (what == 0) return joints();
        if (what == 1) {
            tip("M128", "M129", "M128");
            return;
        }
        if (what == 2) {
            random_move(Mode::joints, true, true, "joints");
            return plane_section(count);
        }
        if (random_.chance(0.4)) {
            say("M128");
            for (int i = 0; i < count; ++i) vector_move("LN", false);
            say("M129");
            return;
        }
        say("M128");
        random_move(Mode::tip, true, true, "M128");
        say("M129");
        say("FUNCTION TCPM F TCP AXIS POS PATHCTRL VECTOR");
        for (int i = 0; i < count; ++i) {
            const Target before = now(Mode::tip);
            for (int attempt = 0; attempt < 20; ++attempt) {
                const Target t = random_target(Mode::tip, true, before);
                bool good = false;
                Path path = plane_turn(t, good, "TCPM vector");
                if (!good || (attempt < 15 && sampler_.coarse(path, 100.0) <= 0.01)) continue;
                add(straight_text(xyz(t.tip) + rotary(t), random_.chance(0.3)), std::move(path));
                break;
            }
        }
        say("FUNCTION RESET TCPM");
        return;
    case Control::siemens:
        if (what == 0) return joints();
        if (what == 1) {
            say("TRAORI");
            say("G54");
            return tip("ORIMKS ORIAXES", "TRAFOOF", "TRAORI axes");
        }
        if (what == 2) {
            random_move(Mode::joints, true, true, "joints");
            return plane_section(count);
        }
        say("TRAORI");
        say("G54");
        say("ORIMKS ORIAXES");
        random_move(Mode::tip, true, true, "TRAORI axes");
        say("ORIWKS ORIVECT");
        for (int i = 0; i < count; ++i) {
            if (random_.chance(0.6)) {
                vector_move("TRAORI A3", true);
                continue;
            }
            const Target before = now(Mode::tip);
            for (int attempt = 0; attempt < 20; ++attempt) {
                const Target t = random_target(Mode::tip, true, before);
                bool good = false;
                Path path = plane_turn(t, good, "TRAORI plane");
                if (!good || (attempt < 15 && sampler_.coarse(path, 100.0) <= 0.01)) continue;
                add(straight_text(xyz(t.tip) + rotary(t), random_.chance(0.3)), std::move(path));
                break;
            }
        }
        say("TRAFOOF");
        say("G54");
        return;
    }
}

void Writer::write_program(int blocks) {
    switch (control_) {
    case Control::fanuc:
    case Control::haas:
        say("G21 G90 G40 G49 G80 G17 G94 G98 G54");
        say("T1 M6");
        break;
    case Control::linuxcnc:
        say("G21 G90 G40 G49 G80 G17 G94 G98 G54 G61");
        say("T1 M6");
        break;
    case Control::heidenhain:
        say("BEGIN PGM RANDOM MM");
        say("TOOL CALL 1 Z S5000");
        break;
    case Control::siemens:
        say("G710 G90 G40 G17 G94 G54 G60");
        say("T1");
        say("M6");
        say("D1");
        break;
    }
    say(klartext() ? "L M3" : "S5000 M3");
    for (int guard = 0; moves_ < blocks && guard < 200; ++guard) section(random_.whole(5, 20));
    if (klartext())
        say("END PGM RANDOM MM");
    else
        say("M30");
}

// ---------------------------------------------------------------------------------------------
// Comparison.

struct Tally {
    std::map<std::string, int> blocks; // compared, by control and kind
    std::map<std::string, int> refusals, undecided;
    std::vector<double> widths, below, above;
    long pairs = 0, near = 0, wrong = 0, unsound = 0, low_upper = 0, skipped = 0, programs = 0;
    long loose = 0, absent = 0;
    std::map<std::string, double> widest;
};

struct Case {
    Control control;
    Arrangement arrangement;
    unsigned seed;
    int blocks;
    double pivot_error = 0.0;
};

std::string save_folder() {
    const char* folder = std::getenv("FEELER_FIVE_AXIS_SAVE");
    return folder ? folder : "";
}

void run_case(const Case& one, Tally& tally) {
    Random random(one.seed);
    Setup setup = random_setup(random, one.control, one.arrangement, one.pivot_error == 0.0);
    if (one.pivot_error != 0.0)
        for (Axis& axis : setup.assumed.axes)
            if (axis.rotary()) {
                // Across the axis, or nothing would move.
                const Vec across = std::abs(axis.direction.x) < 0.7 ? along_x : along_y;
                axis.point = axis.point + one.pivot_error * across;
                break;
            }
    Writer writer(random, setup, one.control);
    writer.write_program(one.blocks);
    std::string program;
    for (const Line& line : writer.lines) program += line.text + "\n";
    const test_support::ScopedFolder folder;
    const std::string ending = one.control == Control::heidenhain ? ".h"
                               : one.control == Control::siemens  ? ".mpf"
                                                                  : ".nc";
    const Checked checked = check_files(folder.write("program" + ending, program),
                                        folder.write("setup.toml", setup.tables), {});
    ++tally.programs;
    const std::string control = name_of(one.control);
    const auto save = [&] {
        if (save_folder().empty()) return;
        const std::string base = fmt::format("{}/{}-{}", save_folder(), control, one.seed);
        std::ofstream(base + ending) << program;
        std::ofstream(base + ".toml") << setup.tables;
    };
    if (std::getenv("FEELER_FIVE_AXIS_KEEP") || checked.status > 2) save();
    if (checked.status == 2 || checked.blocks.empty()) {
        std::string why = checked.err.substr(0, 400);
        ++tally.refusals[control + ": " + why];
    }
    Sampler sampler(setup);
    int reported = 0;
    bool saved = false;
    for (const BlockLine& block : checked.blocks) {
        if (block.line < 1 || block.line > static_cast<int>(writer.lines.size())) continue;
        const Line& line = writer.lines[block.line - 1];
        if (block.motion == "none") {
            if (line.path && checked.status != 2) ++tally.absent;
            continue;
        }
        if (!line.path) {
            if (one.pivot_error == 0.0 && tally.wrong < 20)
                ADD_FAILURE() << "seed " << one.seed << " line " << block.line
                              << " moves: " << block.text;
            ++tally.wrong;
            continue;
        }
        const Path& path = *line.path;
        const std::string kind = control + " " + path.kind;
        // Where the way of the axes is not known, no pair is said to be clear.
        const bool is_measured =
            block.verdict != "undecided"
            && (block.verdict == "clear"
                || std::any_of(block.pairs.begin(), block.pairs.end(),
                               [](const PairLine& pair) { return pair.verdict == "clear"; }));
        if (!is_measured) {
            ++tally.undecided[kind];
            ++tally.skipped;
            continue;
        }
        ++tally.blocks[kind];
        int known = 0;
        for (const PairLine& pair : block.pairs) {
            const size_t blank = pair.name.find(' ');
            const Body* a = sampler.find(pair.name.substr(0, blank));
            const Body* b = sampler.find(pair.name.substr(blank + 1));
            if (!a || !b) continue;
            ++known;
            ++tally.pairs;
            Sampler::Least least =
                sampler.least(*a, *b, path, search_limit + 0.1, 1e-3, pair.lower);
            if (pair.upper && *pair.upper < least.sampled - 1e-5)
                least = sampler.least(*a, *b, path, least.sampled + 1e-9, 1e-3);
            const bool is_unsound = pair.lower > least.sampled + 1e-5;
            bool is_low = pair.upper && *pair.upper < least.sampled - 1e-5;
            // Bodies that overlap where the axes are stated collide, whatever the tolerances allow.
            if (is_low && setup.has_tolerances && *pair.upper == 0.0) is_low = false;
            if (is_low) {
                // Feeler lets the flutes reach 0.005 mm past their end.
                Body longer = *a;
                if (a->name == "flutes") {
                    longer.shapes[0].discs.back().z += 0.005;
                    longer.shapes[0].finish();
                }
                least = sampler.least(longer, *b, path, least.sampled + 1e-9, 1e-5);
                is_low = *pair.upper < least.certain - 1e-6;
            }
            if (pair.upper) {
                ++tally.near;
                const double width = *pair.upper - pair.lower;
                tally.widths.push_back(width);
                tally.below.push_back(least.sampled - pair.lower);
                tally.above.push_back(*pair.upper - least.sampled);
                double& widest = tally.widest[kind];
                widest = std::max(widest, width);
            } else if (pair.lower < search_limit - 1e-9) {
                ++tally.loose;
            }
            if (!is_unsound && !is_low) continue;
            ++tally.wrong;
            tally.unsound += is_unsound;
            tally.low_upper += is_low;
            if (one.pivot_error != 0.0) continue;
            if (++reported <= 3 && tally.wrong < 60)
                ADD_FAILURE() << fmt::format(
                    "{} seed {} {} line {} '{}' ({}) pair {}: [{:.9f}, {}] but sampled {:.9f} at "
                    "{:.9f}, certainly {:.9f}",
                    is_unsound ? "UNSOUND" : "UPPER TOO LOW", one.seed, control, block.line,
                    block.text, path.kind, pair.name, pair.lower,
                    pair.upper ? fmt::format("{:.9f}", *pair.upper) : "-", least.sampled, least.at,
                    least.certain);
            if (!saved) save();
            saved = true;
        }
        if (known == 0 && one.pivot_error == 0.0) ++tally.absent;
    }
}

unsigned number_of(const char* name, unsigned otherwise) {
    const char* text = std::getenv(name);
    return text ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : otherwise;
}

void print(Tally& tally) {
    int blocks = 0;
    for (const auto& [kind, count] : tally.blocks) blocks += count;
    std::cout << fmt::format(
        "{} programs, {} blocks, {} pairs, {} of them near, {} wrong ({} unsound, "
        "{} upper too low), {} undecided blocks, {} without motion or pairs, "
        "{} near without upper\n",
        tally.programs, blocks, tally.pairs, tally.near, tally.wrong, tally.unsound,
        tally.low_upper, tally.skipped, tally.absent, tally.loose);
    for (const auto& [kind, count] : tally.blocks)
        std::cout << fmt::format("  {:<32}{:>8}  widest {:.6f}\n", kind, count, tally.widest[kind]);
    for (const auto& [kind, count] : tally.undecided)
        std::cout << fmt::format("  undecided {:<22}{:>8}\n", kind, count);
    for (const auto& [kind, count] : tally.refusals)
        std::cout << fmt::format("  refused {:>5} {}\n", count, kind);
    const auto ranks = [](const char* name, std::vector<double> values) {
        if (values.empty()) return;
        std::sort(values.begin(), values.end());
        const auto at = [&](double part) {
            return values[static_cast<size_t>(part * static_cast<double>(values.size() - 1))];
        };
        std::cout << fmt::format("  {}: median {:.3g}, 90 % {:.3g}, 99 % {:.3g}, 99.9 % {:.3g}, "
                                 "worst {:.3g}, least {:.3g}\n",
                                 name, at(0.5), at(0.9), at(0.99), at(0.999), at(1.0), at(0.0));
    };
    ranks("upper - lower", tally.widths);
    ranks("sampled - lower", tally.below);
    ranks("upper - sampled", tally.above);
    std::cout << std::flush;
}

void run_control(Control control) {
    const unsigned seed = number_of("FEELER_FIVE_AXIS_SEED", 20261128),
                   programs = number_of("FEELER_FIVE_AXIS_PROGRAMS", 3);
    const int blocks = static_cast<int>(number_of("FEELER_FIVE_AXIS_BLOCKS", 60));
    Tally tally;
    for (unsigned i = 0; i < programs; ++i) {
        run_case({control, static_cast<Arrangement>(i % 3),
                  seed + 1000003u * static_cast<unsigned>(control) + i, blocks},
                 tally);
        if (i % 50 == 49) print(tally);
    }
    print(tally);
    long compared = 0;
    for (const auto& [kind, count] : tally.blocks) compared += count;
    EXPECT_GT(compared, static_cast<long>(programs) * blocks / 2) << "most are compared";
    EXPECT_EQ(tally.unsound, 0);
    EXPECT_EQ(tally.low_upper, 0);
}

TEST(FiveAxisSampling, Fanuc) { run_control(Control::fanuc); }
TEST(FiveAxisSampling, Haas) { run_control(Control::haas); }
TEST(FiveAxisSampling, Heidenhain) { run_control(Control::heidenhain); }
TEST(FiveAxisSampling, Siemens) { run_control(Control::siemens); }
TEST(FiveAxisSampling, Linuxcnc) { run_control(Control::linuxcnc); }

/// A pivot that is wrong by 0.1 mm shows.
TEST(FiveAxisSampling, WouldFindAWrongPivot) {
    for (int i = 0; i < 3; ++i) {
        Tally tally;
        run_case(
            {Control::fanuc, static_cast<Arrangement>(i), 77u + static_cast<unsigned>(i), 60, 0.1},
            tally);
        EXPECT_GT(tally.unsound, 0) << i;
        EXPECT_GT(tally.low_upper, 0) << i;
    }
}

} // namespace
} // namespace app_test
