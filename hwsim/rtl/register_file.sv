// The registers of the host. A write on the bus takes effect at the coming edge, before anything
// else; so what depends on it is given out as it will be then.
module register_file #(
    parameter int ELEMENTS = 8,
    parameter int THREADS = 4,
    parameter int FIFO_DEPTH = 32
) (
    input logic clk,

    // The bus; the address is in bytes.
    input logic bus_write,
    input logic bus_read,
    input logic [11:0] bus_address,
    input logic [31:0] bus_data,
    output logic [31:0] bus_answer,
    output logic irq,

    output logic reset,
    output logic clear,    // a stop
    output logic restart,  // the watchdogs of both memories
    output logic enable,
    output logic [63:0] cycle,  // the number of the coming edge
    output logic host_is_silent,
    output logic [57:0] ring_base,  // in lines
    output logic [4:0] ring_log2_size,
    output logic [31:0] ring_tail,

    input logic [26:0] memory_lines,
    input logic [31:0] ring_head,
    input logic ring_is_idle,
    input logic [12:0] fifo_used,
    input logic [12:0] dispatched,
    input logic [31:0] next_sequence,
    input logic [31:0] permit_sequence,
    input logic [31:0] retired,
    input logic [3:0] stop,  // device::stop_t
    input logic [31:0] stop_sequence,
    input logic [31:0] stop_line,
    input device::answer_t found,
    input logic [31:0] found_sequence,
    input logic has_permitted,
    input logic has_measured,
    input logic has_stopped,

    // Counters
    input logic [63:0] missed,
    input logic [63:0] longest,
    input logic [63:0] least_slack,
    input device::search_totals_t totals,
    input logic [ELEMENTS*device::ELEMENT_COUNTS_BITS-1:0] element_counts,
    input logic [63:0] lines_read,
    input logic [63:0] lines_written,
    input logic [63:0] host_lines
);
  localparam logic [31:0] IDENTIFICATION = 32'h464C_5231;
  localparam logic [31:0] VERSION = 32'd2;
  localparam logic [31:0] MOST_LOG2_SIZE = 32'd16;

  logic [63:0] edges;  // since reset
  logic was_enabled;
  logic [31:0] watchdog, old_watchdog, irq_pending, old_irq_pending, irq_enable, high_word;
  logic [63:0] heartbeat, old_heartbeat;
  logic [57:0] old_base;
  logic [4:0] old_log2_size;
  logic [31:0] old_tail;
  assign cycle = edges + 64'd1;

  // --- Writes

  logic writes_control, is_enabled_now, writes_place;
  assign writes_control = bus_write && bus_address == 12'h018;
  assign reset = writes_control && bus_data[2];
  assign clear = writes_control && !bus_data[2] && bus_data[1];
  assign enable = writes_control ? bus_data[0] : was_enabled;
  assign is_enabled_now = enable && !was_enabled;
  assign restart = is_enabled_now || (clear && stop != device::NO_STOP);
  assign writes_place = bus_write && !was_enabled;
  always_comb begin
    watchdog = bus_write && bus_address == 12'h02C ? bus_data : old_watchdog;
    heartbeat = restart || (bus_write && bus_address == 12'h028) ? edges : old_heartbeat;
    irq_pending = old_irq_pending
        | {29'd0, has_measured, has_stopped, has_permitted};
    ring_base = old_base;
    if (writes_place && bus_address == 12'h080) ring_base[25:0] = bus_data[31:6];
    if (writes_place && bus_address == 12'h084) ring_base[57:26] = bus_data;
    ring_log2_size = old_log2_size;
    if (writes_place && bus_address == 12'h088)
      ring_log2_size = bus_data > MOST_LOG2_SIZE ? MOST_LOG2_SIZE[4:0] : bus_data[4:0];
    ring_tail = bus_write && bus_address == 12'h08C ? bus_data : old_tail;
  end
  assign host_is_silent = watchdog != 0 && cycle - heartbeat > {32'd0, watchdog};
  assign irq = (irq_pending & irq_enable) != 0;

  always_ff @(posedge clk) begin
    edges <= cycle;
    was_enabled <= enable;
    old_watchdog <= watchdog;
    old_heartbeat <= heartbeat;
    old_irq_pending <= bus_write && bus_address == 12'h020 ? irq_pending & ~bus_data : irq_pending;
    if (bus_write && bus_address == 12'h024) irq_enable <= bus_data;
    old_base <= ring_base;
    old_log2_size <= ring_log2_size;
    old_tail <= ring_tail;
    if (bus_read) high_word <= high;
    if (reset) begin
      edges <= '0;
      was_enabled <= 1'b0;
      old_watchdog <= 32'd10_000_000;
      old_heartbeat <= '0;
      old_irq_pending <= '0;
      irq_enable <= '0;
      old_base <= '0;
      old_log2_size <= '0;
      old_tail <= '0;
      high_word <= '0;
    end
  end

  // --- Reads. Of a pair of words, the high one is kept when the low one is read.

  logic [device::ELEMENT_COUNTS_BITS-1:0] added;
  device::element_counts_t sums;
  always_comb begin
    added = '0;
    for (int i = 0; i < ELEMENTS; i++)
      for (int k = 0; k < device::ELEMENT_COUNTS_BITS / 64; k++)
        added[64*k+:64] = added[64*k+:64] + element_counts[i*device::ELEMENT_COUNTS_BITS+64*k+:64];
  end
  assign sums = added;

  logic [63:0] counter;
  always_comb
    case (bus_address[7:3])
      5'd0: counter = edges;
      5'd1: counter = sums.busy;
      5'd2: counter = totals.queries;
      5'd3: counter = totals.nodes;
      5'd4: counter = totals.splits;
      5'd5: counter = totals.box_tests;
      5'd6: counter = totals.pair_tests;
      5'd7: counter = sums.node_hits;
      5'd8: counter = sums.node_misses;
      5'd9: counter = sums.record_hits;
      5'd10: counter = sums.record_misses;
      5'd11: counter = lines_read;
      5'd12: counter = lines_written;
      5'd13: counter = sums.wait_memory;
      5'd14: counter = sums.wait_port;
      5'd15: counter = sums.wait_retire;
      5'd16: counter = missed;
      5'd17: counter = {57'd0, totals.deepest};
      5'd18: counter = least_slack;
      5'd19: counter = longest;
      5'd20: counter = host_lines;
      default: counter = '0;
    endcase

  logic is_counter, is_stopped;
  assign is_counter = bus_address[11:8] == 4'd1 && bus_address[7:3] <= 5'd20 && bus_address[1:0] == 0;
  assign is_stopped = stop != device::NO_STOP;
  logic [31:0] status, high;
  assign status = {28'd0, fifo_used == 13'(FIFO_DEPTH),
      (is_stopped || ring_is_idle) && fifo_used == 0 && dispatched == 0, is_stopped, was_enabled};
  always_comb begin
    high = high_word;
    if (is_counter && !bus_address[2]) high = counter[63:32];
    if (bus_address == 12'h050) high = {13'd0, found.squared[50:32]};
  end

  always_comb
    if (is_counter) bus_answer = bus_address[2] ? high_word : counter[31:0];
    else
      case (bus_address)
        12'h000: bus_answer = IDENTIFICATION;
        12'h004: bus_answer = VERSION;
        12'h008: bus_answer = ELEMENTS;
        12'h00C: bus_answer = THREADS;
        12'h010: bus_answer = {5'd0, memory_lines};
        12'h014: bus_answer = FIFO_DEPTH;
        12'h01C: bus_answer = status;
        12'h020: bus_answer = irq_pending;
        12'h024: bus_answer = irq_enable;
        12'h02C: bus_answer = old_watchdog;
        12'h030: bus_answer = {19'd0, fifo_used};
        12'h034: bus_answer = permit_sequence;
        12'h038: bus_answer = retired;
        12'h03C: bus_answer = next_sequence;
        12'h040: bus_answer = {28'd0, stop};
        12'h044: bus_answer = stop_sequence;
        12'h048: bus_answer = stop_line;
        12'h050: bus_answer = found.squared[31:0];
        12'h054: bus_answer = high_word;
        12'h058: bus_answer = {4'd0, found.tool_record};
        12'h05C: bus_answer = {4'd0, found.work_record};
        12'h060: bus_answer = {19'd0, found.sample};
        12'h064: bus_answer = found_sequence;
        12'h068: bus_answer = {31'd0, found.found};
        12'h080: bus_answer = {old_base[25:0], 6'd0};
        12'h084: bus_answer = old_base[57:26];
        12'h088: bus_answer = {27'd0, old_log2_size};
        12'h08C: bus_answer = old_tail;
        12'h090: bus_answer = ring_head;
        default: bus_answer = '0;
      endcase
endmodule
