#pragma once

#include <deque>
#include <functional>

#include "core/geom/profile.h"
#include "hwsim/coprocessor.h"
#include "hwsim/stock_model.h"

namespace hwsim {

/// How a driver reaches a device, whatever is behind it: registers and memory, and nothing else.
struct DevicePort {
    std::function<uint32_t(Register)> read;
    std::function<void(uint32_t address, uint32_t value)> write; // address in bytes
    std::function<bool(uint32_t line, const Line&)> store;       // by DMA; false: no room yet
    std::function<void()> wait; // a little time passes, because something is not ready
};

/// A device of which every cycle is emulated. Each access to a register takes some cycles, and so
/// does each wait.
struct EmulatedDevice {
    DeviceConfig config;
    CoprocessorState state;
    uint32_t bus_cycles = 4;

    bool operator==(const EmulatedDevice&) const = default;
};

/// Errors: those of checked().
core::Result<EmulatedDevice> emulated_device(const DeviceConfig& config);

/// The functional model behind the same registers: what is pushed is answered at once.
struct FunctionalDevice {
    DeviceConfig config;
    CoprocessorState state; // without elements

    bool operator==(const FunctionalDevice&) const = default;
};

/// Errors: those of checked().
core::Result<FunctionalDevice> functional_device(const DeviceConfig& config);

/// The devices must live as long as the ports, where they are. `after_cycle` looks on.
DevicePort port_of(EmulatedDevice& device,
                   std::function<void(const CoprocessorState&)> after_cycle = {});
DevicePort port_of(FunctionalDevice& device);

/// A slot of the device, by number.
enum class SlotNumber : uint8_t {};

/// The host's side of a device: what is in its memory and its slots, and which numbers come next.
/// It reaches the device by its port only.
struct Driver {
    /// What a slot holds, or will hold when the FIFO gets there.
    struct Slot {
        Side side = Side::work;
        uint32_t header = 0, epoch = 0;
        std::vector<LineRun> runs;       // of a model that does not change
        std::optional<StockModel> stock; // of one that is cut
        bool is_free = false;
    };
    /// Lines that are needed until so many entries are retired.
    struct Released {
        uint32_t entries = 0;
        std::vector<LineRun> runs;
    };

    DevicePort port;
    LineSpace space;
    std::vector<Slot> slots;
    std::vector<Line> written; // by address: what a line with a wrong bit is written again from
    std::deque<Released> released;
    uint32_t next_sequence = 1;
    uint32_t entries = 0;   // pushed since reset
    uint32_t leaf_size = 4; // of models of the work; those of tools have 1
};

/// One pair of bodies that must keep apart over a segment.
struct PairToKeep {
    SlotNumber tool{}, work{};
    double distance = 0.0; // mm: the allowance, and what else the host adds to it
};

/// A straight segment of the path. Frame: the work's; places of the tool's origin.
struct PathSegment {
    core::Vec3 from = core::Vec3(0.0), to = core::Vec3(0.0);
    std::vector<PairToKeep> pairs;
    double sample_step = 0.1; // mm: from one sample to the next, at most
    uint32_t budget = 0;      // cycles until the permit is needed; 0: none
};

/// What the device says now.
struct DeviceReport {
    uint32_t permitted = 0; // every segment up to this may be entered
    Stop stop = Stop::none;
    uint32_t stop_sequence = 0, stop_line = 0;
    bool idle = false;
};

/// The nearest pair of a violation or a measurement.
struct FoundPair {
    uint64_t squared = 0;
    uint32_t tool_record = 0, work_record = 0;
    uint16_t sample = 0;
    uint32_t sequence = 0;
    double sample_step = 0.0; // of a measurement: from one of its samples to the next, mm

    double distance() const; // of the records, mm
};

/// What the bodies of a measured pair keep over the segment, at least, mm (README.md, "Error
/// bound").
double least_clearance(const FoundPair& found);

/// Resets a device and makes it ready.
///
/// Errors: a device that does not know itself, or of another version.
core::Result<Driver> open_device(DevicePort port);

/// Brings a tool into the device: a body of revolution, upright, by cylinders.
///
/// Errors: those of cylinders_round(); no free slot; the memory is full, or takes no lines; what
///         does not fit.
core::Result<SlotNumber> load_tool(Driver& driver, const core::RevolvedProfile& profile,
                                   double tolerance = 0.02);

/// Brings a model of records in.
core::Result<SlotNumber> load_records(Driver& driver, Side side, std::vector<Record> records);

/// Brings a stock in; to be updated when it is cut.
core::Result<SlotNumber> load_stock(Driver& driver, const core::CutModel& stock);

/// Takes a model out of the device. Segments pushed before are still held
/// against it; its slot may be given to another one.
void unload(Driver& driver, SlotNumber slot);

/// From the next segment on the stock is as it is now: changed tiles go by DMA, and the new epoch
/// through the FIFO. Returns how many tiles.
///
/// Errors: no stock; the memory is full, and the stock is then the one before, which is larger; the
///         memory takes no lines, and segments are then refused.
core::Result<size_t> update_stock(Driver& driver, SlotNumber slot, const core::CutModel& stock);

/// Asks for a permit, and returns the segment's number. Into a device that has stopped nothing
/// goes: its number will not be permitted.
///
/// Errors: no pairs, a place or distance beyond the device's numbers, a slot of the wrong side.
core::Result<uint32_t> push(Driver& driver, const PathSegment& segment);

/// Measures how near a pair comes, looking no farther than its distance, or however far if that is
/// 0; waits for the answer. None if they keep it, if one of the models is empty, or the device
/// stops.
core::Result<std::optional<FoundPair>> measure(Driver& driver, const PathSegment& segment);

/// What the device says now; tells it as well that the host is alive.
DeviceReport report(Driver& driver);

/// Waits until everything pushed is answered or the device has stopped.
DeviceReport wait_for_all(Driver& driver);

/// The pair of the violation that stopped the device, or of the last measurement.
std::optional<FoundPair> found_pair(Driver& driver);

/// Clears the reason of a stop, and gives the device its models again; a line with a wrong bit is
/// written anew. The next segment has the number after the last one permitted.
void recover(Driver& driver);

} // namespace hwsim
