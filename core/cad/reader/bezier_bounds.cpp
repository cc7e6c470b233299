#include "core/cad/reader/bezier_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace core::cad {

void VectorBound::include(const Vec3& v) {
    length = std::max(length, glm::length(v));
    each = glm::max(each, glm::abs(v));
}

void VectorBound::include(const VectorBound& other) {
    length = std::max(length, other.length);
    each = glm::max(each, other.each);
}

void DerivativeBounds::include(const DerivativeBounds& other) {
    first.include(other.first);
    second.include(other.second);
    kink.include(other.kink);
    known = known && other.known;
}

void SurfaceDerivativeBounds::include(const SurfaceDerivativeBounds& other) {
    u = std::max(u, other.u);
    v = std::max(v, other.v);
    uu = std::max(uu, other.uu);
    uv = std::max(uv, other.uv);
    vv = std::max(vv, other.vv);
    kink_u = std::max(kink_u, other.kink_u);
    kink_v = std::max(kink_v, other.kink_v);
    known = known && other.known;
}

namespace {

VectorBound scaled(VectorBound bound, double by) { return {bound.length * by, bound.each * by}; }

VectorBound sum(const VectorBound& a, const VectorBound& b) {
    return {a.length + b.length, a.each + b.each};
}

/// A curve in homogeneous coordinates, relative to a centre: numerator and weight.
struct Numerator {
    std::vector<Vec3> top;
    std::vector<double> weight;
};

Numerator numerator(const BezierArc& arc, const Vec3& centre) {
    Numerator n;
    for (const WeightedPole& pole : arc) {
        n.top.push_back(pole.weight * (pole.at - centre));
        n.weight.push_back(pole.weight);
    }
    return n;
}

/// The coefficients of the derivative by the parameter, which runs from 0 to 1.
template <typename Value>
std::vector<Value> derivative(const std::vector<Value>& poles) {
    std::vector<Value> slopes;
    for (size_t i = 1; i < poles.size(); ++i)
        slopes.push_back(static_cast<double>(poles.size() - 1) * (poles[i] - poles[i - 1]));
    return slopes;
}

VectorBound bound(const std::vector<Vec3>& poles) {
    VectorBound most;
    for (const Vec3& pole : poles) most.include(pole);
    return most;
}

double bound(const std::vector<double>& poles) {
    double most = 0.0;
    for (const double pole : poles) most = std::max(most, std::abs(pole));
    return most;
}

Vec3 middle(const BezierArc& arc) {
    Vec3 total(0.0);
    for (const WeightedPole& pole : arc) total += pole.at;
    return total / static_cast<double>(arc.size());
}

double least_weight(const BezierArc& arc) {
    double least = std::numeric_limits<double>::infinity();
    for (const WeightedPole& pole : arc) least = std::min(least, pole.weight);
    return least;
}

WeightedPole mean(const WeightedPole& a, const WeightedPole& b) {
    const double weight = 0.5 * (a.weight + b.weight);
    return {0.5 * (a.weight * a.at + b.weight * b.at) / weight, weight};
}

double binomial(size_t n, size_t k) {
    double value = 1.0;
    for (size_t i = 0; i < k; ++i) value *= static_cast<double>(n - i) / static_cast<double>(i + 1);
    return value;
}

} // namespace

// With E = C - L for a linear function L near C, and A = w E: A' = w' E + w E', and so on. E and E'
// are small, so that hardly more is added to the bounds of a rational arc than they are.
DerivativeBounds bounds_of(const BezierArc& arc, double length) {
    DerivativeBounds bounds;
    const double weight = least_weight(arc);
    bounds.known = weight > 0.0 && length > 0.0;
    if (!bounds.known) return bounds;
    const Vec3 from = arc.front().at, along = arc.back().at - from;
    const size_t degree = arc.size() - 1;
    std::vector<Vec3> top(degree + 2, Vec3(0.0));
    std::vector<double> weights;
    for (size_t i = 0; i <= degree; ++i) {
        const double before = static_cast<double>(i) / static_cast<double>(degree + 1);
        const WeightedPole& pole = arc[i];
        top[i] += (1.0 - before) * pole.weight * (pole.at - from);
        top[i + 1] += (static_cast<double>(i + 1) / static_cast<double>(degree + 1)) * pole.weight
                      * (pole.at - from - along);
        weights.push_back(pole.weight);
    }
    const std::vector<Vec3> top1 = derivative(top), top2 = derivative(top1);
    const std::vector<double> weight1 = derivative(weights), weight2 = derivative(weight1);
    const VectorBound off = scaled(bound(top), 1.0 / weight);
    const VectorBound first = scaled(sum(bound(top1), scaled(off, bound(weight1))), 1.0 / weight);
    const VectorBound second = scaled(
        sum(bound(top2), sum(scaled(first, 2.0 * bound(weight1)), scaled(off, bound(weight2)))),
        1.0 / weight);
    bounds.first = scaled(sum(first, bound(std::vector<Vec3>{along})), 1.0 / length);
    bounds.second = scaled(second, 1.0 / (length * length));
    return bounds;
}

ArcHalves halves(const BezierArc& arc) {
    ArcHalves both;
    BezierArc rest = arc;
    for (size_t left = arc.size(); left > 0; --left) {
        both.first.push_back(rest.front());
        both.second.push_back(rest[left - 1]);
        for (size_t i = 0; i + 1 < left; ++i) rest[i] = mean(rest[i], rest[i + 1]);
    }
    std::reverse(both.second.begin(), both.second.end());
    return both;
}

BezierArc extended(const BezierArc& arc, double before) {
    BezierArc rest = arc, found;
    for (size_t left = arc.size(); left > 0; --left) {
        found.push_back(rest[left - 1]);
        for (size_t i = 0; i + 1 < left; ++i) {
            const WeightedPole &a = rest[i], &b = rest[i + 1];
            const double weight = (1.0 + before) * a.weight - before * b.weight;
            rest[i] = {((1.0 + before) * a.weight * a.at - before * b.weight * b.at) / weight,
                       weight};
        }
    }
    std::reverse(found.begin(), found.end());
    return found;
}

VectorBound kink_between(const BezierArc& before, double length_before, const BezierArc& after,
                         double length_after) {
    const Vec3 joint = after.front().at;
    const Numerator a = numerator(before, joint), b = numerator(after, joint);
    // At the joint, A = 0, so that C' = A' / w.
    VectorBound kink;
    kink.include(derivative(b.top).front() / (b.weight.front() * length_after)
                 - derivative(a.top).back() / (a.weight.back() * length_before));
    return kink;
}

namespace {

/// A net of values, row by row along u.
template <typename Value>
struct Net {
    size_t rows, columns;
    std::vector<Value> values;

    Net(size_t row_count, size_t column_count)
        : rows(row_count), columns(column_count), values(row_count * column_count, Value(0.0)) {}
    Value& at(size_t i, size_t k) { return values[i * columns + k]; }
    const Value& at(size_t i, size_t k) const { return values[i * columns + k]; }
};

double size_of(double value) { return std::abs(value); }
double size_of(const Vec3& value) { return glm::length(value); }

template <typename Value>
double bound(const Net<Value>& net) {
    double most = 0.0;
    for (const Value& value : net.values) most = std::max(most, size_of(value));
    return most;
}

template <typename Value>
Net<Value> derivative_by_u(const Net<Value>& net) {
    if (net.rows < 2) return {1, 1};
    Net<Value> slopes(net.rows - 1, net.columns);
    for (size_t i = 0; i + 1 < net.rows; ++i)
        for (size_t k = 0; k < net.columns; ++k)
            slopes.at(i, k) = static_cast<double>(net.rows - 1) * (net.at(i + 1, k) - net.at(i, k));
    return slopes;
}

template <typename Value>
Net<Value> derivative_by_v(const Net<Value>& net) {
    if (net.columns < 2) return {1, 1};
    Net<Value> slopes(net.rows, net.columns - 1);
    for (size_t i = 0; i < net.rows; ++i)
        for (size_t k = 0; k + 1 < net.columns; ++k)
            slopes.at(i, k) =
                static_cast<double>(net.columns - 1) * (net.at(i, k + 1) - net.at(i, k));
    return slopes;
}

/// The greatest values of a net and of its derivatives by parameters from 0 to 1.
struct NetBounds {
    double value, u, v, uu, uv, vv;
};

template <typename Value>
NetBounds bounds_of(const Net<Value>& net) {
    const Net<Value> u = derivative_by_u(net), v = derivative_by_v(net);
    return {bound(net),
            bound(u),
            bound(v),
            bound(derivative_by_u(u)),
            bound(derivative_by_v(u)),
            bound(derivative_by_v(v))};
}

/// A function that is linear in u and in v, by its slopes.
struct Affine {
    Vec3 from, along_u, along_v;

    Vec3 at(size_t u, size_t v) const {
        return from + static_cast<double>(u) * along_u + static_cast<double>(v) * along_v;
    }
};

/// The function between the corners of a patch.
Affine affine_near(const BezierPatch& patch) {
    const Vec3 a = patch.rows.front().front().at, b = patch.rows.front().back().at,
               c = patch.rows.back().front().at, d = patch.rows.back().back().at;
    return {a, 0.5 * (c - a + d - b), 0.5 * (b - a + d - c)};
}

/// Weight times difference from the function: one degree more in u and in v.
Net<Vec3> numerator_less(const BezierPatch& patch, const Affine& function) {
    const size_t rows = patch.rows.size(), columns = patch.rows.front().size();
    Net<Vec3> net(rows + 1, columns + 1);
    for (size_t i = 0; i < rows; ++i)
        for (size_t k = 0; k < columns; ++k)
            for (const size_t a : {0, 1})
                for (const size_t b : {0, 1}) {
                    const double i_share =
                        static_cast<double>(a == 0 ? rows - i : i + 1) / static_cast<double>(rows);
                    const double k_share = static_cast<double>(b == 0 ? columns - k : k + 1)
                                           / static_cast<double>(columns);
                    const WeightedPole& pole = patch.rows[i][k];
                    net.at(i + a, k + b) +=
                        i_share * k_share * pole.weight * (pole.at - function.at(a, b));
                }
    return net;
}

} // namespace

SurfaceDerivativeBounds bounds_of(const BezierPatch& patch, double length_u, double length_v) {
    Net<double> weights(patch.rows.size(), patch.rows.front().size());
    double least = std::numeric_limits<double>::infinity();
    for (size_t i = 0; i < weights.rows; ++i)
        for (size_t k = 0; k < weights.columns; ++k) {
            weights.at(i, k) = patch.rows[i][k].weight;
            least = std::min(least, weights.at(i, k));
        }
    SurfaceDerivativeBounds bounds;
    bounds.known = least > 0.0 && length_u > 0.0 && length_v > 0.0;
    if (!bounds.known) return bounds;
    const Affine near = affine_near(patch);
    const NetBounds top = bounds_of(numerator_less(patch, near)), w = bounds_of(weights);
    const double off = top.value / least;
    const double u = (top.u + off * w.u) / least, v = (top.v + off * w.v) / least;
    bounds.u = (u + glm::length(near.along_u)) / length_u;
    bounds.v = (v + glm::length(near.along_v)) / length_v;
    bounds.uu = (top.uu + 2.0 * u * w.u + off * w.uu) / least / (length_u * length_u);
    bounds.vv = (top.vv + 2.0 * v * w.v + off * w.vv) / least / (length_v * length_v);
    bounds.uv = (top.uv + u * w.v + v * w.u + off * w.uv) / least / (length_u * length_v);
    return bounds;
}

BezierPatch transposed(const BezierPatch& patch) {
    BezierPatch turned{std::vector<BezierArc>(patch.rows.front().size())};
    for (const BezierArc& row : patch.rows)
        for (size_t k = 0; k < row.size(); ++k) turned.rows[k].push_back(row[k]);
    return turned;
}

namespace {

/// The patch divided along v into `count` equal ones.
std::vector<BezierPatch> divided_along_v(const BezierPatch& patch, int count) {
    if (count == 1) return {patch};
    BezierPatch first, second;
    for (const BezierArc& row : patch.rows) {
        ArcHalves both = halves(row);
        first.rows.push_back(std::move(both.first));
        second.rows.push_back(std::move(both.second));
    }
    std::vector<BezierPatch> all = divided_along_v(first, count / 2);
    for (BezierPatch& part : divided_along_v(second, count / 2)) all.push_back(std::move(part));
    return all;
}

} // namespace

std::vector<BezierPatch> divided(const BezierPatch& patch, int count) {
    std::vector<BezierPatch> all;
    for (const BezierPatch& strip : divided_along_v(transposed(patch), count))
        for (BezierPatch& part : divided_along_v(transposed(strip), count))
            all.push_back(std::move(part));
    return all;
}

// On the common border, numerator A and weight w agree, so S_u jumps by (w dA - dw A) / w^2, with
// dA and dw the jumps of A_u and w_u. The product is a Bezier curve of twice the degree.
double kink_between(const BezierPatch& before, double length_before, const BezierPatch& after,
                    double length_after) {
    const BezierArc& border = after.rows.front();
    const double weight = least_weight(border);
    if (!(weight > 0.0)) return 0.0; // its patch is not known either
    const Vec3 centre = middle(border);
    const size_t last = before.rows.size() - 1, m = border.size() - 1;
    const Numerator a0 = numerator(before.rows[last - 1], centre),
                    a1 = numerator(before.rows[last], centre), b0 = numerator(border, centre),
                    b1 = numerator(after.rows[1], centre);
    const double scale_before = static_cast<double>(last) / length_before;
    const double scale_after = static_cast<double>(after.rows.size() - 1) / length_after;
    std::vector<Vec3> product(2 * m + 1, Vec3(0.0));
    for (size_t i = 0; i <= m; ++i)
        for (size_t k = 0; k <= m; ++k) {
            const Vec3 top =
                scale_after * (b1.top[k] - b0.top[k]) - scale_before * (a1.top[k] - a0.top[k]);
            const double heavy = scale_after * (b1.weight[k] - b0.weight[k])
                                 - scale_before * (a1.weight[k] - a0.weight[k]);
            const double share = binomial(m, i) * binomial(m, k) / binomial(2 * m, i + k);
            product[i + k] += share * (b0.weight[i] * top - heavy * b0.top[i]);
        }
    return bound(product).length / (weight * weight);
}

} // namespace core::cad
