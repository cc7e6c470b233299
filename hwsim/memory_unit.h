#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <utility>
#include <vector>

#include "hwsim/memory_line.h"

namespace hwsim {

struct DeviceConfig;

template <typename T>
/// A FIFO of fixed depth, as in the circuit: a memory, a read position and a level.
class Ring {
public:
    Ring() = default;
    explicit Ring(size_t depth) : items_(depth) {}

    bool empty() const { return level_ == 0; }
    bool full() const { return level_ == items_.size(); }
    size_t size() const { return level_; }
    size_t free() const { return items_.size() - level_; }
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

/// A line that an element wants to read.
struct ReadRequest {
    bool valid = false;
    uint8_t element = 0, thread = 0;
    uint32_t run = 0; // counts stops: requests from before a stop are ignored after it
    uint32_t address = 0;

    bool operator==(const ReadRequest&) const = default;
};

/// A unit that takes a question in each cycle, does not stall, and answers after `stages` cycles.
///
/// In the circuit the work is done on the way; here an answer is computed when it is asked for.
template <typename Answer, uint32_t stages>
class Pipeline {
public:
    static constexpr uint32_t latency = stages;

    const Answer& output() const { return stage_[next_]; }

    /// One rising clock edge; an answer that is not valid is none.
    void tick(const Answer& in) {
        // An empty stage keeps its old contents except `valid`.
        if (in.valid)
            stage_[next_] = in;
        else
            stage_[next_].valid = false;
        next_ = next_ + 1 == stages ? 0 : next_ + 1;
    }

    bool operator==(const Pipeline&) const = default;

private:
    // Stages rotate instead of their contents: `next_` is where a question enters and the oldest
    // answer leaves.
    std::array<Answer, stages> stage_{};
    uint32_t next_ = 0;
};

/// A line for the element that requested it.
struct ReadResponse {
    bool valid = false;
    bool is_intact = false; // by its check word
    ReadRequest request;
    Line line;

    bool operator==(const ReadResponse&) const = default;
};

/// Gives memory whose bytes are 0, for types of which that is the default value. The system makes a
/// page when it is first used: a device has far more memory than most programs need.
template <typename T>
struct ZeroedAllocator {
    using value_type = T;

    ZeroedAllocator() = default;
    template <typename U>
    explicit ZeroedAllocator(const ZeroedAllocator<U>&) {}

    T* allocate(size_t count) {
        static_assert(alignof(T) >= sizeof(void*));
        void* whole = std::calloc(1, count * sizeof(T) + alignof(T));
        if (whole == nullptr) throw std::bad_alloc();
        // calloc knows no alignment. What it gave stands before the first item.
        auto* const first = static_cast<char*>(whole) + alignof(T)
                            - reinterpret_cast<uintptr_t>(whole) % alignof(T);
        reinterpret_cast<void**>(first)[-1] = whole;
        return reinterpret_cast<T*>(first);
    }
    void deallocate(T* first, size_t) noexcept { std::free(reinterpret_cast<void**>(first)[-1]); }

    template <typename U>
    void construct(U*) noexcept {}
    template <typename U, typename... Values>
    void construct(U* place, Values&&... values) {
        ::new (static_cast<void*>(place)) U(std::forward<Values>(values)...);
    }

    bool operator==(const ZeroedAllocator&) const = default;
};

using DeviceMemory = std::vector<Line, ZeroedAllocator<Line>>;

/// Compares lines with their check words, four words a stage.
using CheckUnit = Pipeline<ReadResponse, 4>;

/// The memory and its port. Reads are in order, each after the latency, limited by the bandwidth; a
/// line is read when its turn comes at the port, and checked when it arrives.
/// Lines that are copied from the host are interleaved: when no read waits, or alternating with
/// reads while the write queue is full.
struct MemoryUnit {
    struct Pending {
        ReadRequest request;
        uint64_t arrives = 0; // cycle
        Line line;
        bool operator==(const Pending&) const = default;
    };
    struct Write {
        uint32_t address = 0;
        Line line;
        bool operator==(const Write&) const = default;
    };

    DeviceMemory lines;
    Ring<ReadRequest> asked;
    Ring<Pending> under_way;
    Ring<Write> writes;
    uint64_t free_at = 0;        // cycle in which the port is free
    bool write_was_last = false; // so a read has priority
    uint64_t waited = 0;  // cycles in which nothing was read, written or answered, but should
    bool stalled = false; // no responses: injected fault

    CheckUnit check;          // its output is that of the unit
    bool has_written = false; // output: caches invalidate the line
    uint32_t written = 0;     // its address
    uint64_t reads_done = 0, writes_done = 0;

    bool operator==(const MemoryUnit&) const = default;
};

MemoryUnit memory_unit(const DeviceConfig& config);

/// Whether a request can be accepted.
inline bool accepts(const MemoryUnit& unit) { return !unit.asked.full(); }

/// One rising clock edge.
void tick(MemoryUnit& unit, const DeviceConfig& config, uint64_t cycle, const ReadRequest& in);

/// Whether something waits for the memory, which has done nothing for longer than the limit.
bool is_stalled(const MemoryUnit& unit, const DeviceConfig& config);

} // namespace hwsim
