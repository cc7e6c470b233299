#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>

namespace core {

/// A segment of a line inside a body; empty unless lower < upper.
struct Interval {
    double lower = 0.0;
    double upper = 0.0;

    double length() const { return upper - lower; }
    bool operator==(const Interval&) const = default;
};

/// The material on one scan line: sorted, disjoint intervals with gaps between neighbours. A single
/// interval, the usual case, is stored in the object; more are stored on the heap.
class IntervalList {
public:
    IntervalList() = default;
    explicit IntervalList(const Interval& interval) { add(interval); }
    IntervalList(const IntervalList& other);
    IntervalList(IntervalList&& other) noexcept { swap(other); }
    IntervalList& operator=(const IntervalList& other);
    IntervalList& operator=(IntervalList&& other) noexcept;
    ~IntervalList();

    /// Removes `cut` from the list and returns the removed length.
    ///
    /// Result:  the remaining intervals are closed: their new ends are the ends of `cut`. An empty
    ///          cut changes nothing.
    double subtract(const Interval& cut);

    /// Adds `interval` to the list; touching intervals are merged. An empty one changes nothing.
    void add(const Interval& interval);

    /// Whether `x` is inside an interval, ends included.
    bool contains(double x) const;

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

/// Read access to the material on one line wherever it is stored: sorted, disjoint intervals with
/// gaps between neighbours. Valid until the line changes.
class LineView {
public:
    class Iterator {
    public:
        using iterator_category = std::random_access_iterator_tag;
        using value_type = Interval;
        using difference_type = std::ptrdiff_t;
        using pointer = const Interval*;
        using reference = Interval;

        Iterator() = default;
        Iterator(const double* lower, const double* upper, std::ptrdiff_t stride)
            : lower_(lower), upper_(upper), stride_(stride) {}

        Interval operator*() const { return {*lower_, *upper_}; }
        Interval operator[](std::ptrdiff_t i) const { return *(*this + i); }
        Iterator& operator+=(std::ptrdiff_t by) {
            lower_ += by * stride_;
            upper_ += by * stride_;
            return *this;
        }
        Iterator& operator-=(std::ptrdiff_t by) { return *this += -by; }
        Iterator& operator++() { return *this += 1; }
        Iterator operator++(int) {
            const Iterator before = *this;
            ++*this;
            return before;
        }
        Iterator& operator--() { return *this += -1; }
        Iterator operator+(std::ptrdiff_t by) const { return Iterator(*this) += by; }
        Iterator operator-(std::ptrdiff_t by) const { return Iterator(*this) -= by; }
        std::ptrdiff_t operator-(const Iterator& b) const { return (lower_ - b.lower_) / stride_; }
        bool operator==(const Iterator& b) const { return lower_ == b.lower_; }
        auto operator<=>(const Iterator& b) const { return lower_ <=> b.lower_; }

    private:
        const double* lower_ = nullptr;
        const double* upper_ = nullptr;
        std::ptrdiff_t stride_ = 1;
    };

    LineView() = default;
    /// Interval i is stored `stride` doubles after interval i - 1.
    LineView(const double* lower, const double* upper, std::ptrdiff_t stride, size_t size)
        : lower_(lower), upper_(upper), stride_(stride), size_(size) {}
    LineView(const IntervalList& list) // NOLINT: implicit on purpose
        : LineView(&list.begin()->lower, &list.begin()->upper,
                   static_cast<std::ptrdiff_t>(sizeof(Interval) / sizeof(double)), list.size()) {}

    bool empty() const { return size_ == 0; }
    size_t size() const { return size_; }
    Iterator begin() const { return {lower_, upper_, stride_}; }
    Iterator end() const { return begin() + static_cast<std::ptrdiff_t>(size_); }
    Interval operator[](size_t i) const { return begin()[static_cast<std::ptrdiff_t>(i)]; }
    Interval front() const { return (*this)[0]; }
    Interval back() const { return (*this)[size_ - 1]; }

    /// Whether `x` is inside an interval, ends included.
    bool contains(double x) const {
        return std::any_of(begin(), end(),
                           [x](const Interval& i) { return i.lower <= x && x <= i.upper; });
    }
    double length() const {
        double sum = 0.0;
        for (const Interval& i : *this) sum += i.length();
        return sum;
    }
    IntervalList list() const {
        IntervalList copy;
        for (const Interval& i : *this) copy.add(i);
        return copy;
    }
    friend bool operator==(const LineView& a, const LineView& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end());
    }

private:
    const double* lower_ = nullptr;
    const double* upper_ = nullptr;
    std::ptrdiff_t stride_ = 1;
    size_t size_ = 0;
};

} // namespace core
