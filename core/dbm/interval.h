#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace core {

/// A stretch of a line that holds matter; empty unless lower < upper.
struct Interval {
    double lower = 0.0;
    double upper = 0.0;

    double length() const { return upper - lower; }
    bool operator==(const Interval&) const = default;
};

/// The matter on one scan line: sorted, disjoint intervals with a gap between neighbours. One
/// interval, the usual case, is held in place; only more of them need the heap.
class IntervalList {
public:
    IntervalList() = default;
    explicit IntervalList(const Interval& interval) { add(interval); }
    IntervalList(const IntervalList& other);
    IntervalList(IntervalList&& other) noexcept { swap(other); }
    IntervalList& operator=(const IntervalList& other);
    IntervalList& operator=(IntervalList&& other) noexcept;
    ~IntervalList();

    /// Takes `cut` out of the list and returns the length that was really removed.
    ///
    /// Result: what stays is closed: its new ends are the ends of `cut`. An empty cut changes
    /// nothing.
    double subtract(const Interval& cut);

    /// Unites the list with `interval`; touching intervals become one. An empty one changes
    /// nothing.
    void add(const Interval& interval);

    /// Whether `x` lies on matter, ends included.
    bool contains(double x) const;
    double length() const;

    bool empty() const { return size_ == 0; }
    size_t size() const { return size_; }
    const Interval* begin() const { return data(); }
    const Interval* end() const { return data() + size_; }
    const Interval& operator[](size_t i) const { return data()[i]; }
    bool operator==(const IntervalList& other) const;

private:
    bool on_heap() const { return capacity_ > 1; }
    const Interval* data() const { return on_heap() ? many : &one; }
    Interval* data() { return on_heap() ? many : &one; }
    void swap(IntervalList& other) noexcept;
    void reserve(uint32_t capacity);
    /// Replaces the intervals first .. last - 1 by `with`.
    void replace(size_t first, size_t last, std::span<const Interval> with);

    union {
        Interval one = {};
        Interval* many;
    };
    uint32_t size_ = 0;
    uint32_t capacity_ = 1;
};

} // namespace core
