#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

namespace hwsim {

/// A FIFO of fixed depth, as in the circuit: a memory, a place to read and a level.
template <typename T>
class Ring {
public:
    Ring() = default;
    explicit Ring(size_t depth) : items_(depth) {}

    bool empty() const { return level_ == 0; }
    bool full() const { return level_ == items_.size(); }
    size_t size() const { return level_; }
    const T& front() const {
        assert(!empty());
        return items_[first_];
    }
    T& front() {
        assert(!empty());
        return items_[first_];
    }
    void push(const T& item) {
        assert(!full());
        size_t at = first_ + level_++;
        if (at >= items_.size()) at -= items_.size();
        items_[at] = item;
    }
    void pop() {
        assert(!empty());
        if (++first_ == items_.size()) first_ = 0;
        --level_;
    }
    void clear() { level_ = 0; }

    bool operator==(const Ring&) const = default;

private:
    std::vector<T> items_;
    size_t first_ = 0, level_ = 0;
};

} // namespace hwsim
