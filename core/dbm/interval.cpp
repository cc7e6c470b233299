#include "core/dbm/interval.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

namespace core {

IntervalList::IntervalList(const IntervalList& other) {
    reserve(other.size_);
    std::copy(other.begin(), other.end(), data());
    size_ = other.size_;
}

IntervalList& IntervalList::operator=(const IntervalList& other) {
    if (this == &other) return *this;
    reserve(other.size_);
    std::copy(other.begin(), other.end(), data());
    size_ = other.size_;
    return *this;
}

IntervalList& IntervalList::operator=(IntervalList&& other) noexcept {
    swap(other);
    return *this;
}

IntervalList::~IntervalList() {
    if (on_heap()) delete[] many;
}

void IntervalList::swap(IntervalList& other) noexcept {
    const bool mine = on_heap(), others = other.on_heap();
    const Interval own_one = mine ? Interval{} : one;
    const Interval given_one = others ? Interval{} : other.one;
    Interval* const own_many = mine ? many : nullptr;
    if (others)
        many = other.many;
    else
        one = given_one;
    if (mine)
        other.many = own_many;
    else
        other.one = own_one;
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
}

void IntervalList::reserve(uint32_t capacity) {
    if (capacity <= capacity_) return;
    const uint32_t grown = std::max(capacity, 2 * capacity_);
    auto* const bigger = new Interval[grown];
    std::copy(begin(), end(), bigger);
    if (on_heap()) delete[] many;
    many = bigger;
    capacity_ = grown;
}

void IntervalList::replace(size_t first, size_t last, std::span<const Interval> with) {
    const size_t count_after = size_ - last;
    const auto new_size = static_cast<uint32_t>(first + with.size() + count_after);
    reserve(new_size);
    Interval* const all = data();
    if (first + with.size() > last)
        std::copy_backward(all + last, all + size_, all + new_size);
    else
        std::copy(all + last, all + size_, all + first + with.size());
    std::copy(with.begin(), with.end(), all + first);
    size_ = new_size;
}

double IntervalList::subtract(const Interval& cut) {
    assert(!std::isnan(cut.lower) && !std::isnan(cut.upper));
    if (!(cut.lower < cut.upper)) return 0.0;
    const Interval* const first = std::partition_point(
        begin(), end(), [&](const Interval& i) { return i.upper <= cut.lower; });
    const Interval* const last =
        std::partition_point(first, end(), [&](const Interval& i) { return i.lower < cut.upper; });
    if (first == last) return 0.0;

    double removed = 0.0;
    for (const Interval* i = first; i != last; ++i)
        removed += std::min(i->upper, cut.upper) - std::max(i->lower, cut.lower);
    std::array<Interval, 2> rest = {};
    size_t rests = 0;
    if (first->lower < cut.lower) rest[rests++] = {first->lower, cut.lower};
    if (cut.upper < (last - 1)->upper) rest[rests++] = {cut.upper, (last - 1)->upper};
    replace(static_cast<size_t>(first - begin()), static_cast<size_t>(last - begin()),
            std::span(rest.data(), rests));
    return removed;
}

void IntervalList::add(const Interval& interval) {
    assert(!std::isnan(interval.lower) && !std::isnan(interval.upper));
    if (!(interval.lower < interval.upper)) return;
    // Intervals that only touch are merged too, so that there is always a gap between neighbours.
    const Interval* const first = std::partition_point(
        begin(), end(), [&](const Interval& i) { return i.upper < interval.lower; });
    const Interval* const last = std::partition_point(
        first, end(), [&](const Interval& i) { return i.lower <= interval.upper; });
    Interval united = interval;
    if (first != last) {
        united.lower = std::min(united.lower, first->lower);
        united.upper = std::max(united.upper, (last - 1)->upper);
    }
    replace(static_cast<size_t>(first - begin()), static_cast<size_t>(last - begin()),
            std::span(&united, 1));
}

bool IntervalList::contains(double x) const {
    const Interval* const at =
        std::partition_point(begin(), end(), [&](const Interval& i) { return i.upper < x; });
    return at != end() && at->lower <= x;
}

bool IntervalList::operator==(const IntervalList& other) const {
    return std::equal(begin(), end(), other.begin(), other.end());
}

} // namespace core
