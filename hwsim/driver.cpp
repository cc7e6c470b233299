#include "hwsim/driver.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/dbm/cut_model.h"
#include "hwsim/coprocessor.h"
#include "hwsim/search.h"
#include "hwsim/tool_model.h"

namespace hwsim {
namespace {

/// An emulated device with its observer.
struct ObservedDevice {
    EmulatedDevice& device;
    std::function<void(const CoprocessorState&)> after_cycle;

    void cycles(uint32_t count) const {
        for (uint32_t i = 0; i < count; ++i) {
            tick(device.state, device.config);
            if (after_cycle) after_cycle(device.state);
        }
    }
    void access() const { cycles(device.bus_cycles); }
};

/// Processes one entry of the FIFO, from its models to its permit.
void answer_first(FunctionalDevice& device) {
    CoprocessorState& s = device.state;
    const OrderedEntry entry = s.fifo.entries.front();
    s.fifo.entries.pop();
    s.permits.in_order.push({.segment = entry.segment, .asked = entry.asked});
    Answer answer;
    if (entry.segment.kind == SegmentKind::model)
        store_model(s, entry.segment);
    else
        answer.stop = fault_of_models(s, entry.segment);
    if (entry.segment.kind != SegmentKind::model && answer.stop == Stop::none)
        answer = search(s.memory.lines, query_of(s, entry.segment), device.config.stack_depth,
                        device.config.volumes);
    retire_with(s, answer);
}

void copy_all(CoprocessorState& s) {
    LineCopy& copy = s.ring.current.copy;
    for (; copy.count > 0; --copy.count, ++copy.line, copy.from += sizeof(Line)) {
        const Line* line = s.shared.at(copy.from);
        if (!line) return halt(s, Stop::bad_address, s.permits.permit_sequence + 1, copy.line);
        s.memory.lines[copy.line] = *line;
        ++s.ring.lines_asked;
        ++s.ring.reads_done;
        ++s.memory.writes_done;
    }
}

void take_next_line(FunctionalDevice& device) {
    CoprocessorState& s = device.state;
    const uint32_t number = s.ring.head;
    const Line* line = s.shared.at(address_in_ring(s.ring, number));
    ++s.ring.fetched;
    ++s.ring.reads_done;
    if (line)
        take_line(s.ring, {true, false, is_intact(*line, number), s.run, number, s.cycle, *line},
                  device.config);
    else
        halt(s, Stop::bad_address, s.permits.permit_sequence + 1, number);
}

/// Carries out a step of an order; false if there is none, or no room for it.
bool carry_out(FunctionalDevice& device) {
    CoprocessorState& s = device.state;
    if (s.permits.stopped != Stop::none) return false;
    if (is_overrun(s.ring)) {
        halt(s, Stop::fifo_overrun, s.permits.permit_sequence + 1, s.ring.tail);
    } else if (has_copy(s.ring)) {
        copy_all(s);
    } else if (has_entry(s.ring)) {
        if (s.fifo.entries.full()) return false;
        const OrderedEntry entry = take_entry(s.ring, s.run);
        if (entry.valid) take_order(s, entry, s.ring.fault);
    } else if (s.ring.head != s.ring.tail) {
        take_next_line(device);
    } else {
        return false;
    }
    if (s.ring.fault.valid) take_order(s, {}, s.ring.fault);
    return true;
}

/// Processes everything that can be processed.
void settle(FunctionalDevice& device) {
    CoprocessorState& s = device.state;
    if (std::exchange(s.flush, false)) drop_orders(s.ring);
    do {
        while (s.host.enabled && !s.fifo.entries.empty()) answer_first(device);
    } while (carry_out(device));
}

} // namespace

core::Result<EmulatedDevice> emulated_device(const DeviceConfig& config) {
    FEELER_TRY(const DeviceConfig good, checked(config));
    return EmulatedDevice{good, power_up(good)};
}

core::Result<FunctionalDevice> functional_device(const DeviceConfig& config) {
    FEELER_TRY(const DeviceConfig good, checked(config));
    FunctionalDevice device{good, power_up(good)};
    device.state.elements.clear();
    return device;
}

DevicePort port_of(EmulatedDevice& device,
                   std::function<void(const CoprocessorState&)> after_cycle) {
    const ObservedDevice observed{device, std::move(after_cycle)};
    return {.read =
                [observed](Register r) {
                    observed.access();
                    return read(observed.device.state, observed.device.config, address_of(r));
                },
            .write =
                [observed](uint32_t address, uint32_t value) {
                    observed.access();
                    write(observed.device.state, observed.device.config, address, value);
                },
            .wait = [observed] { observed.access(); },
            .shared = &device.state.shared};
}

DevicePort port_of(FunctionalDevice& device) {
    return {
        .read = [&device](Register r) { return read(device.state, device.config, address_of(r)); },
        .write =
            [&device](uint32_t address, uint32_t value) {
                write(device.state, device.config, address, value);
                device.state.elements.clear(); // a reset creates them again
                settle(device);
            },
        .wait = [] {},
        .shared = &device.state.shared};
}

namespace {

constexpr auto index_of(SlotNumber slot) { return static_cast<size_t>(slot); }

uint32_t read(Driver& driver, Register r) { return driver.port.read(r); }
void write(Driver& driver, Register r, uint32_t value) { driver.port.write(address_of(r), value); }

void ring_doorbell(Driver& driver) { write(driver, Register::ring_tail, driver.tail); }

bool is_stopped(Driver& driver) { return (read(driver, Register::status) & status_stopped) != 0; }

constexpr uint32_t ring_size = 1U << Driver::log2_ring_size;

/// The device's copy of a line of its memory, in the memory that is shared.
Line& image_of(Driver& driver, uint32_t line) {
    std::vector<Line>& lines = driver.port.shared->lines;
    const size_t at = size_t{ring_size} + line;
    if (at >= lines.size()) lines.resize(at + 1);
    return lines[at];
}

/// Puts lines into the ring once it has room, without the doorbell. A stopped device ignores them.
void add_to_ring(Driver& driver, std::vector<Line> lines) {
    driver.lines_made += lines.size();
    const auto has_room = [&] {
        return uint32_t{driver.tail - driver.head} + lines.size() <= ring_size;
    };
    while (!has_room()) {
        ring_doorbell(driver);
        driver.head = read(driver, Register::ring_head);
        if (has_room()) break;
        if (is_stopped(driver)) return;
        write(driver, Register::heartbeat, 1);
        driver.port.wait();
    }
    for (Line& line : lines) {
        seal(line, driver.tail);
        driver.port.shared->lines[driver.tail++ % ring_size] = line;
    }
}

void order_copy(Driver& driver, uint32_t line, uint32_t count) {
    // Copies before the last one that was taken are carried out even if the device stops.
    while (!driver.copies.empty()
           && static_cast<int32_t>(driver.head - 1 - driver.copies.front().number) > 0)
        driver.copies.pop_front();
    driver.copies.push_back({driver.tail, line, count});
    add_to_ring(driver, {descriptor_of(LineCopy{HostMemory::address_of(size_t{ring_size} + line),
                                                line, count})});
}

/// Orders copies of lines that are in the image.
void order_copies(Driver& driver, std::vector<uint32_t> lines) {
    std::sort(lines.begin(), lines.end());
    for (size_t i = 0; i < lines.size();) {
        uint32_t count = 1;
        while (i + count < lines.size() && lines[i + count] == lines[i] + count) ++count;
        order_copy(driver, lines[i], count);
        i += count;
    }
}

void store(Driver& driver, const std::vector<AddressedLine>& lines) {
    std::vector<uint32_t> addresses;
    driver.lines_made += lines.size();
    for (const AddressedLine& line : lines) {
        image_of(driver, line.address) = line.line;
        addresses.push_back(line.address);
    }
    order_copies(driver, std::move(addresses));
}

void give_back_first(Driver& driver) {
    for (const LineRun& run : driver.released.front().runs) give_back(driver.space, run);
    driver.released.pop_front();
}

/// Frees the lines of models that no search needs any more. Counts may wrap around.
void reclaim(Driver& driver) {
    if (driver.released.empty()) return;
    const uint32_t retired = read(driver, Register::retired);
    while (!driver.released.empty()
           && static_cast<int32_t>(retired - driver.released.front().entries) >= 0)
        give_back_first(driver);
}

/// Does something that needs memory; once more, if there is none, after the device has finished
/// with the models that were released.
template <typename Act>
auto with_memory(Driver& driver, const Act& act) {
    reclaim(driver);
    auto done = act();
    if (done || driver.released.empty()) return done;
    while (!driver.released.empty()) {
        if (is_stopped(driver)) {
            give_back_first(driver); // nothing is searched any more
            continue;
        }
        write(driver, Register::heartbeat, 1);
        driver.port.wait();
        reclaim(driver);
    }
    return act();
}

/// Orders permits or measurements of pairs that have the same path, or a model.
void order(Driver& driver, std::span<const Segment> entries) {
    while (!entries.empty()) {
        const size_t count = std::min<size_t>(entries.size(), Descriptor::most_pairs);
        add_to_ring(driver, descriptor_of(entries.first(count)));
        driver.entries += static_cast<uint32_t>(count);
        entries = entries.subspan(count);
    }
    ring_doorbell(driver);
}

void push_model(Driver& driver, SlotNumber slot) {
    const Driver::Slot& model = driver.slots[index_of(slot)];
    const Segment entry{.sequence = driver.next_sequence,
                        .kind = SegmentKind::model,
                        .work_slot = static_cast<uint8_t>(slot),
                        .last = false,
                        .work_epoch = model.epoch,
                        .model_header = model.header};
    order(driver, {&entry, 1});
}

/// Loads a new model: first its lines into the memory, then its header into a slot.
core::Result<SlotNumber> new_slot(Driver& driver, Driver::Slot slot, LineSpace space,
                                  const std::vector<AddressedLine>& lines) {
    const auto free = std::find_if(driver.slots.begin(), driver.slots.end(),
                                   [](const Driver::Slot& old) { return old.is_free; });
    if (free == driver.slots.end() && driver.slots.size() == model_slots)
        return core::fail(
            core::ErrorCode::invalid_value,
            fmt::format("the coprocessor cannot hold more than {} models", model_slots));
    store(driver, lines);
    driver.space = std::move(space);
    const auto number = static_cast<SlotNumber>(free - driver.slots.begin());
    if (free == driver.slots.end())
        driver.slots.push_back(std::move(slot));
    else
        *free = std::move(slot);
    push_model(driver, number);
    return number;
}

core::Result<FixedVec> fixed_position(const core::Vec3& p) {
    FixedVec position{};
    for (size_t axis = 0; axis < 3; ++axis) {
        FEELER_TRY(position[axis], fixed(p[static_cast<int>(axis)], Rounding::nearest));
    }
    return position;
}

/// The entry for one pair, except its number and the `last` flag.
core::Result<Segment> entry_of(const Driver& driver, const PathSegment& path,
                               const RequiredPair& pair) {
    const auto holds = [&](SlotNumber slot, Side side) {
        return index_of(slot) < driver.slots.size() && driver.slots[index_of(slot)].side == side
               && !driver.slots[index_of(slot)].is_free;
    };
    if (!holds(pair.tool, Side::tool) || !holds(pair.work, Side::work))
        return core::fail(core::ErrorCode::invalid_value,
                          "a pair needs one model on the tool side and one on the work side");
    if (!(path.sample_step > 0.0))
        return core::fail(core::ErrorCode::invalid_value,
                          "the distance between samples must be above 0");
    Segment entry{.sequence = driver.next_sequence,
                  .tool_slot = static_cast<uint8_t>(pair.tool),
                  .work_slot = static_cast<uint8_t>(pair.work),
                  .work_epoch = driver.slots[index_of(pair.work)].epoch,
                  .is_timed = path.deadline.has_value(),
                  .deadline = path.deadline.value_or(0)};
    FEELER_TRY(entry.start, fixed_position(path.from));
    FEELER_TRY(entry.end, fixed_position(path.to));
    double step = glm::length(path.to - path.from);
    for (; step > path.sample_step && entry.log2_steps < Segment::most_log2_steps; step *= 0.5)
        ++entry.log2_steps;
    FEELER_TRY(entry.threshold, threshold(pair.distance, step));
    return entry;
}

core::Result<std::vector<Segment>> entries_of(const Driver& driver, const PathSegment& path) {
    if (path.pairs.empty())
        return core::fail(core::ErrorCode::invalid_value, "a segment needs at least one pair");
    std::vector<Segment> entries;
    for (const RequiredPair& pair : path.pairs) {
        FEELER_TRY(const Segment entry, entry_of(driver, path, pair));
        entries.push_back(entry);
    }
    return entries;
}

} // namespace

double FoundPair::distance() const { return std::sqrt(static_cast<double>(squared)) * lsb; }

double least_clearance(const FoundPair& found) {
    // At some sample, the bodies are within hypot(clearance, half a step) of each other, and their
    // records are farther apart than that by less than the reserve.
    const double at_sample = found.distance() - rounding_reserve * lsb;
    const double half_step = 0.5 * found.sample_step;
    if (at_sample <= half_step) return 0.0;
    return std::sqrt((at_sample - half_step) * (at_sample + half_step));
}

core::Result<Driver> open_device(DevicePort port) {
    Driver driver{.port = std::move(port)};
    if (read(driver, Register::identification) != identification_word
        || read(driver, Register::version) != version_word)
        return core::fail(core::ErrorCode::unsupported,
                          "the device at the port is not a coprocessor of this version");
    write(driver, Register::control, control_reset);
    driver.space.end = read(driver, Register::lines);
    driver.volumes = static_cast<Volumes>(read(driver, Register::volumes));
    driver.port.shared->lines.assign(ring_size, {});
    constexpr uint64_t base = HostMemory::address_of(0);
    write(driver, Register::ring_base_low, static_cast<uint32_t>(base));
    write(driver, Register::ring_base_high, static_cast<uint32_t>(base >> 32));
    write(driver, Register::ring_log2_size, Driver::log2_ring_size);
    write(driver, Register::control, control_enable);
    return driver;
}

core::Result<SlotNumber> load_tool(Driver& driver, const core::RevolvedProfile& profile,
                                   double tolerance) {
    FEELER_TRY(std::vector<Record> records, cylinders_round(profile, tolerance));
    return load_records(driver, Side::tool, std::move(records));
}

core::Result<SlotNumber> load_records(Driver& driver, Side side, std::vector<Record> records) {
    return with_memory(driver, [&]() -> core::Result<SlotNumber> {
        LineSpace space = driver.space;
        ModelWriter writer{.space = &space, .side = side, .volumes = driver.volumes, .epoch = 1};
        Branch root;
        if (!records.empty()) {
            FEELER_TRY(root, add_tree(writer, records, side == Side::tool ? 1 : driver.leaf_size));
        }
        FEELER_TRY(const uint32_t header, add_header(writer, root));
        return new_slot(driver, {side, header, 1, writer.runs, {}}, std::move(space), writer.lines);
    });
}

core::Result<SlotNumber> load_stock(Driver& driver, const core::CutModel& stock) {
    return with_memory(driver, [&]() -> core::Result<SlotNumber> {
        Driver::Slot slot{.stock = stock_model(cells_of(stock), driver.leaf_size, driver.volumes)};
        LineSpace space = driver.space;
        FEELER_TRY(const StockUpdate done, update(*slot.stock, space, stock.columns));
        slot.header = done.header;
        slot.epoch = done.epoch;
        return new_slot(driver, std::move(slot), std::move(space), done.lines);
    });
}

void unload(Driver& driver, SlotNumber number) {
    if (index_of(number) >= driver.slots.size()) return;
    Driver::Slot& slot = driver.slots[index_of(number)];
    if (slot.is_free) return;
    slot.is_free = true;
    driver.released.push_back(
        {driver.entries, slot.stock ? lines_of(*slot.stock) : std::move(slot.runs)});
    reclaim(driver);
}

core::Result<size_t> update_stock(Driver& driver, SlotNumber number, const core::CutModel& stock) {
    if (index_of(number) >= driver.slots.size() || driver.slots[index_of(number)].is_free
        || !driver.slots[index_of(number)].stock)
        return core::fail(core::ErrorCode::invalid_value, "only a stock can be cut");
    Driver::Slot& slot = driver.slots[index_of(number)];
    if (is_current(*slot.stock, stock.columns)) return 0;
    FEELER_TRY(const StockUpdate done, with_memory(driver, [&] {
                   return update(*slot.stock, driver.space, stock.columns);
               }));
    slot.header = done.header;
    slot.epoch = done.epoch;
    store(driver, done.lines);
    push_model(driver, number);
    driver.released.push_back({driver.entries, done.released});
    return done.tiles;
}

core::Result<uint32_t> push(Driver& driver, const PathSegment& segment) {
    FEELER_TRY(std::vector<Segment> entries, entries_of(driver, segment));
    for (Segment& entry : entries) entry.last = false;
    entries.back().last = true;
    order(driver, entries);
    return driver.next_sequence++;
}

core::Result<std::optional<FoundPair>> measure(Driver& driver, const PathSegment& segment) {
    FEELER_TRY(const std::vector<Segment> entries, entries_of(driver, segment));
    std::optional<FoundPair> nearest;
    for (size_t i = 0; i < entries.size(); ++i) {
        Segment entry = entries[i];
        entry.kind = SegmentKind::measure;
        if (segment.pairs[i].distance == 0.0) entry.threshold = 0;
        entry.last = false;
        order(driver, {&entry, 1});
        if (wait_for_all(driver).stop != Stop::none) return std::optional<FoundPair>();
        std::optional<FoundPair> pair = found_pair(driver);
        if (pair)
            pair->sample_step =
                std::ldexp(glm::length(segment.to - segment.from), -int{entry.log2_steps});
        if (pair && (!nearest || pair->squared < nearest->squared)) nearest = pair;
    }
    return nearest;
}

DeviceReport report(Driver& driver) {
    write(driver, Register::heartbeat, 1);
    reclaim(driver);
    DeviceReport now;
    const uint32_t status = read(driver, Register::status);
    now.idle = (status & status_idle) != 0;
    if ((status & status_stopped) != 0) {
        now.stop = static_cast<Stop>(read(driver, Register::stop));
        now.stop_sequence = read(driver, Register::stop_seq);
        now.stop_line = read(driver, Register::stop_line);
    }
    now.permitted = read(driver, Register::permit_seq);
    return now;
}

DeviceReport wait_for_all(Driver& driver) {
    DeviceReport now = report(driver);
    while (!now.idle && now.stop == Stop::none) {
        driver.port.wait();
        now = report(driver);
    }
    return now;
}

std::optional<FoundPair> found_pair(Driver& driver) {
    if (read(driver, Register::found_valid) == 0) return {};
    FoundPair pair;
    pair.squared = read(driver, Register::found_low);
    pair.squared |= uint64_t{read(driver, Register::found_high)} << 32;
    pair.tool_record = read(driver, Register::found_tool);
    pair.work_record = read(driver, Register::found_work);
    pair.sample = static_cast<uint16_t>(read(driver, Register::found_sample));
    pair.sequence = read(driver, Register::found_seq);
    return pair;
}

void recover(Driver& driver) {
    if (!is_stopped(driver)) return;
    const auto reason = static_cast<Stop>(read(driver, Register::stop));
    const uint32_t line = read(driver, Register::stop_line);
    driver.head = read(driver, Register::ring_head);
    ring_doorbell(driver);
    write(driver, Register::control, control_clear | control_enable);
    const std::deque<Driver::PendingCopy> copies = std::exchange(driver.copies, {});
    const uint32_t last_taken = driver.head - 1;
    driver.head = driver.tail;
    for (const Driver::PendingCopy& copy : copies)
        if (static_cast<int32_t>(copy.number - last_taken) >= 0)
            order_copy(driver, copy.line, copy.count);
    if (reason == Stop::bad_check && line < driver.space.next) order_copy(driver, line, 1);
    driver.next_sequence = read(driver, Register::next_seq);
    // Nothing is pending any more, so the old models are not needed.
    driver.entries = read(driver, Register::retired);
    for (Driver::Released& old : driver.released) old.entries = driver.entries;
    reclaim(driver);
    for (size_t i = 0; i < driver.slots.size(); ++i)
        if (!driver.slots[i].is_free) push_model(driver, static_cast<SlotNumber>(i));
}

} // namespace hwsim
