#include "core/geom/orientation.h"

#include <array>
#include <cmath>

namespace core {
namespace {

/// A sum of doubles kept exactly: components that do not overlap, smallest first.
class ExactSum {
public:
    void add(double x) {
        size_t kept = 0;
        for (size_t i = 0; i < size_; ++i) {
            const double sum = x + parts_[i];
            const double of_part = sum - x;
            const double rest = (x - (sum - of_part)) + (parts_[i] - of_part);
            if (rest != 0.0) parts_[kept++] = rest;
            x = sum;
        }
        if (x != 0.0) parts_[kept++] = x;
        size_ = kept;
    }

    void add_product(double x, double y) {
        const double product = x * y;
        add(std::fma(x, y, -product));
        add(product);
    }

    double value() const {
        double sum = 0.0;
        for (size_t i = 0; i < size_; ++i) sum += parts_[i];
        return sum;
    }

private:
    std::array<double, 16> parts_ = {};
    size_t size_ = 0;
};

double exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    // Multiplied out, so that no difference is rounded: c.x c.y cancels.
    ExactSum sum;
    sum.add_product(a.x, b.y);
    sum.add_product(-a.x, c.y);
    sum.add_product(-c.x, b.y);
    sum.add_product(-a.y, b.x);
    sum.add_product(a.y, c.x);
    sum.add_product(c.y, b.x);
    return sum.value();
}

} // namespace

double orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    const double left = (a.x - c.x) * (b.y - c.y);
    const double right = (a.y - c.y) * (b.x - c.x);
    const double area = left - right;
    // Each product is within 2.0e-16 * 3 of itself; asking for 0.004 leaves 1e-13 of the
    // difference.
    if (std::abs(area) > 0.004 * (std::abs(left) + std::abs(right))) return area;
    return exact_orientation(a, b, c);
}

} // namespace core
