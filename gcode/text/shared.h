#pragma once

#include <atomic>
#include <memory>

namespace gcode {

/// A copy-on-write value: copies share it until one of them is written to. Copies may be used in
/// different threads.
template <typename T>
class Shared {
public:
    Shared() = default;
    ~Shared() = default;
    Shared(const Shared&) = default;
    Shared(Shared&&) = default;
    Shared& operator=(Shared&&) = default;
    Shared& operator=(const Shared& other) {
        if (value_ != other.value_) value_ = other.value_; // avoids the cost of counting references
        return *this;
    }

    const T& operator*() const { return *value_; }
    const T* operator->() const { return value_.get(); }

    /// The value for writing; it is copied first if it is shared.
    T& write() {
        if (value_.use_count() > 1)
            value_ = std::make_shared<T>(*value_);
        else
            // use_count is a relaxed read: another thread that has just dropped its copy must have
            // finished reading it.
            std::atomic_thread_fence(std::memory_order_acquire);
        return *value_;
    }

    bool operator==(const Shared& other) const {
        return value_ == other.value_ || *value_ == *other.value_;
    }

private:
    std::shared_ptr<T> value_ = std::make_shared<T>();
};

} // namespace gcode
