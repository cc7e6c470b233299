#pragma once

#include <deque>
#include <functional>

#include "core/geom/profile.h"
#include "hwsim/registers.h"
#include "hwsim/ring_unit.h"
#include "hwsim/stock_model.h"

namespace hwsim {

/// The interface of a driver to any device: registers, and memory that both can read.
struct DevicePort {
    std::function<uint32_t(Register)> read;
    std::function<void(uint32_t address, uint32_t value)> write; // address in bytes
    std::function<void()> wait;                                  // called to let a little time pass
    HostMemory* shared = nullptr; // written by the driver, read by the device
};

/// A slot of the device, by number.
enum class SlotNumber : uint8_t {};

/// The host side of a device: the contents of its memory and slots, and the next sequence number.
/// Accesses the device through its port only.
struct Driver {
    /// The contents of a slot after all queued entries are processed.
    struct Slot {
        Side side = Side::work;
        uint32_t header = 0, epoch = 0;
        std::vector<LineRun> runs;       // of a constant model
        std::optional<StockModel> stock; // of a model that is cut
        bool is_free = false;
    };
    /// Lines that are in use until `entries` entries are retired.
    struct Released {
        uint32_t entries = 0;
        std::vector<LineRun> runs;
    };

    /// A copy that the device may not have carried out.
    struct PendingCopy {
        uint32_t number = 0; // of its descriptor
        uint32_t line = 0, count = 0;
    };
    static constexpr uint32_t log2_ring_size = 8;

    // The shared memory holds the ring, then all lines of the device's memory that are in use: what
    // is to be copied, and what a corrupted line should be.
    DevicePort port;
    LineSpace space;
    std::vector<Slot> slots;
    std::deque<Released> released;
    std::deque<PendingCopy> copies;
    uint32_t tail = 0, head = 0; // of the ring; `head` as last read
    uint32_t next_sequence = 1;
    uint32_t entries = 0;    // pushed since reset
    uint64_t lines_made = 0; // descriptors, and lines of models
    uint32_t leaf_size = 4;  // of work models; tool models have 1
    Volumes volumes = Volumes::boxes;
};

/// A pair of bodies with its minimum distance over a segment.
struct RequiredPair {
    SlotNumber tool{}, work{};
    double distance = 0.0; // mm: the allowance plus the error bounds that the host adds
};

/// A straight segment of the path. Frame: the work's; positions of the tool origin.
struct PathSegment {
    core::Vec3 from = core::Vec3(0.0), to = core::Vec3(0.0);
    std::vector<RequiredPair> pairs;
    double sample_step = 0.1;              // mm: greatest distance between two samples
    std::optional<uint32_t> deadline = {}; // low word of the cycle in which the permit is needed
};

/// The nearest pair of a violation or a measurement.
struct FoundPair {
    uint64_t squared = 0;
    uint32_t tool_record = 0, work_record = 0;
    uint16_t sample = 0;
    uint32_t sequence = 0;
    double sample_step = 0.0; // of a measurement, mm

    double distance() const; // of the records, mm
};

/// A lower bound of the clearance of a measured pair over the segment, mm (README.md, "Error
/// bound").
double least_clearance(const FoundPair& found);

/// Resets a device and initialises it.
///
/// Errors:  the device does not identify itself, or has another version.
core::Result<Driver> open_device(DevicePort port);

/// Loads a tool into the device: an upright body of revolution, as cylinders. For users of the
/// driver; a check uses load_records() with records that it has prepared.
///
/// Errors:  those of cylinders_round(); no free slot; the memory is full; coordinates out of range.
core::Result<SlotNumber> load_tool(Driver& driver, const core::RevolvedProfile& profile,
                                   double tolerance = 0.02);

/// Loads a model of records.
core::Result<SlotNumber> load_records(Driver& driver, Side side, std::vector<Record> records);

/// Loads a stock; call update_stock() after cuts.
core::Result<SlotNumber> load_stock(Driver& driver, const core::CutModel& stock);

/// Removes a model from the device. Segments pushed before still use it; its slot may be reused.
void unload(Driver& driver, SlotNumber slot);

/// Updates a stock for the segments from the next one on: orders copies of its changed tiles, then
/// the new epoch. Returns the number of tiles.
///
/// Errors:  not a stock; the memory is full: the stock stays as before, which is larger.
core::Result<size_t> update_stock(Driver& driver, SlotNumber slot, const core::CutModel& stock);

/// Requests a permit and returns the sequence number of the segment. A stopped device ignores it:
/// the number will not be permitted.
///
/// Errors:  no pairs, a position or distance out of range, a slot of the wrong side.
core::Result<uint32_t> push(Driver& driver, const PathSegment& segment);

/// Measures the distance of a pair, up to the distance given for it, or without limit if that is 0;
/// waits for the answer. Empty if the pair is farther apart, if a model is empty, or if the device
/// stops.
core::Result<std::optional<FoundPair>> measure(Driver& driver, const PathSegment& segment);

/// The current state of the device. Also serves as heartbeat of the host.
DeviceReport report(Driver& driver);

/// Waits until everything pushed is answered or the device has stopped.
DeviceReport wait_for_all(Driver& driver);

/// The pair of the violation that stopped the device, or of the last measurement.
std::optional<FoundPair> found_pair(Driver& driver);

/// Clears a stop and reloads the models; a corrupted line is rewritten. The next segment has the
/// number after the last permitted one.
void recover(Driver& driver);

} // namespace hwsim
