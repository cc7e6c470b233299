// The squared distance of a swept volume and a box, or of two records: a question in each cycle, its
// answer 25 cycles later.
//
// Two records are a volume and a box as well: the box of the work grows by half its side, that of
// the tool by its height, and both offsets are the same.
module gap_unit #(
    parameter int THREAD_BITS = 2
) (
    input logic clk,
    input logic flush,

    input logic                   in_valid,
    input logic [THREAD_BITS-1:0] in_thread,
    input device::gap_question_t  question,

    output logic                   out_valid,
    output logic [THREAD_BITS-1:0] out_thread,
    output device::gap_answer_t    answer
);
  localparam int STAGES = 25;
  localparam int ROOT_STAGES = 13;
  localparam int GAPS = 4;                         // the stages of the gaps
  localparam int LEVEL = GAPS + 3;                 // the sum of the squares along X and Y
  localparam int ROOT = LEVEL + ROOT_STAGES;       // its root
  localparam int APART = ROOT + 2;                 // less the radius

  // What only travels along: thread, kind, names.
  localparam int TAG_BITS = THREAD_BITS + 2 + 2 * device::NAME_BITS;
  logic [STAGES:1] valid;
  logic [TAG_BITS-1:0] tag[1:STAGES];
  always_ff @(posedge clk) begin
    valid <= flush ? '0 : {valid[STAGES-1:1], in_valid};
    tag[1] <= {in_thread, question.of_records, question.half, question.tool_name, question.work_name};
    for (int i = 2; i <= STAGES; i++) tag[i] <= tag[i-1];
  end
  assign out_valid = valid[STAGES];
  assign out_thread = tag[STAGES][TAG_BITS-1-:THREAD_BITS];


  // Stages 1 to 4.
  logic [23:0] gap_x, gap_y, gap_z;
  logic range_x, range_y, range_z;
  device::extent_t radius[1:ROOT];
  always_ff @(posedge clk) begin
    radius[1] <= question.of_records ? question.tool_record.half : question.tool_volume.radius;
    for (int i = 2; i <= ROOT; i++) radius[i] <= radius[i-1];
  end
  gap_axis x (.clk, .of_records(question.of_records), .offset_0(question.offset_0.x), .offset_1(question.offset_1.x),
      .tool_min(question.tool_volume.box.min.x), .tool_max(question.tool_volume.box.max.x), .work_min(question.work_box.min.x), .work_max(question.work_box.max.x),
      .tool_base(question.tool_record.base.x), .tool_below(20'd0), .tool_above(20'd0),
      .work_base(question.work_record.base.x), .work_below(question.work_record.half), .work_above(question.work_record.half),
      .aside(radius[2]), .in_range(range_x), .gap(gap_x));
  gap_axis y (.clk, .of_records(question.of_records), .offset_0(question.offset_0.y), .offset_1(question.offset_1.y),
      .tool_min(question.tool_volume.box.min.y), .tool_max(question.tool_volume.box.max.y), .work_min(question.work_box.min.y), .work_max(question.work_box.max.y),
      .tool_base(question.tool_record.base.y), .tool_below(20'd0), .tool_above(20'd0),
      .work_base(question.work_record.base.y), .work_below(question.work_record.half), .work_above(question.work_record.half),
      .aside(radius[2]), .in_range(range_y), .gap(gap_y));
  gap_axis z (.clk, .of_records(question.of_records), .offset_0(question.offset_0.z), .offset_1(question.offset_1.z),
      .tool_min(question.tool_volume.box.min.z), .tool_max(question.tool_volume.box.max.z), .work_min(question.work_box.min.z), .work_max(question.work_box.max.z),
      .tool_base(question.tool_record.base.z), .tool_below(20'd0), .tool_above(question.tool_record.run),
      .work_base(question.work_record.base.z), .work_below(20'd0), .work_above(question.work_record.run),
      .aside(20'd0), .in_range(range_z), .gap(gap_z));

  logic [STAGES:GAPS+1] fits;
  always_ff @(posedge clk) fits <= {fits[STAGES-1:GAPS+1], range_x & range_y & range_z};

  // Stages 5 to 7: the squares, and their sum.
  logic [47:0] square_x, square_y;
  squarer #(24) squarer_x (.clk, .root(gap_x), .square(square_x));
  squarer #(24) squarer_y (.clk, .root(gap_y), .square(square_y));
  logic [49:0] level[LEVEL:STAGES-1];
  logic [23:0] height[GAPS+1:APART];
  always_ff @(posedge clk) begin
    level[LEVEL] <= 50'(square_x) + 50'(square_y);
    for (int i = LEVEL + 1; i < STAGES; i++) level[i] <= level[i-1];
    height[GAPS+1] <= gap_z;
    for (int i = GAPS + 2; i <= APART; i++) height[i] <= height[i-1];
  end

  // Stages 8 to 20: the root, rounded down, and what remains.
  logic [24:0] root;
  logic has_rest;
  root_pipeline root_of_level (.clk, .square(level[LEVEL]), .root, .has_rest);

  // Stages 21 and 22: rounded up, less the radius, at least 0. Stages 23 to 25: the square of it, or
  // the sum as it was if there is no radius; and the square of the height.
  logic signed [26:0] less_radius;
  logic [24:0] apart;
  logic [STAGES-1:ROOT+1] has_radius;
  logic [49:0] square_apart;
  logic [47:0] square_height;
  squarer #(25) squarer_apart (.clk, .root(apart), .square(square_apart));
  squarer #(24) squarer_height (.clk, .root(height[APART]), .square(square_height));
  always_ff @(posedge clk) begin
    less_radius <= $signed({2'b0, root}) + $signed({26'd0, has_rest}) - $signed({7'd0, radius[ROOT]});
    has_radius <= {has_radius[STAGES-2:ROOT+1], radius[ROOT] != 0};
    apart <= less_radius < 0 ? '0 : less_radius[24:0];
    squared <= (has_radius[STAGES-1] ? square_apart : level[STAGES-1]) + 50'(square_height);
  end

  device::squared_t squared;
  localparam int NAMES = 2 * device::NAME_BITS;
  assign answer = {tag[STAGES][NAMES+1], tag[STAGES][NAMES], fits[STAGES], tag[STAGES][NAMES-1:0], squared};
endmodule

// The gap along one axis between what moves from offset_0 to offset_1 and what is at rest.
module gap_axis (
    input logic clk,
    input logic of_records,
    input device::coordinate_t offset_0, offset_1,
    input device::coordinate_t tool_min, tool_max, work_min, work_max,  // of boxes
    input device::coordinate_t tool_base, work_base,                    // of records
    input device::extent_t tool_below, tool_above, work_below, work_above,
    input device::extent_t aside,  // in stage 2: how far the tool extends beyond its box
    output logic in_range,
    output logic [23:0] gap
);
  typedef logic signed [26:0] wide_t;
  function automatic wide_t widened(input device::extent_t extent);
    widened = $signed({7'd0, extent});
  endfunction
  function automatic logic fits(input wide_t value);
    fits = value >= 27'(device::LEAST) && value <= 27'(device::GREATEST);
  endfunction

  device::coordinate_t low, high;
  wide_t tool_low, tool_high, work_low[1:2], work_high[1:2];
  wide_t moved_low, moved_high, gap_below, gap_above;
  logic fits_3;
  always_ff @(posedge clk) begin
    // 1: boxes of records, ends of the motion
    low <= offset_0 < offset_1 ? offset_0 : offset_1;
    high <= offset_0 < offset_1 ? offset_1 : offset_0;
    tool_low <= of_records ? 27'(tool_base) - widened(tool_below) : 27'(tool_min);
    tool_high <= of_records ? 27'(tool_base) + widened(tool_above) : 27'(tool_max);
    work_low[1] <= of_records ? 27'(work_base) - widened(work_below) : 27'(work_min);
    work_high[1] <= of_records ? 27'(work_base) + widened(work_above) : 27'(work_max);
    // 2: the swept box
    moved_low <= tool_low + 27'(low);
    moved_high <= tool_high + 27'(high);
    work_low[2] <= work_low[1];
    work_high[2] <= work_high[1];
    // 3: both gaps
    gap_below <= work_low[2] - moved_high;
    gap_above <= moved_low - work_high[2];
    fits_3 <= fits(moved_low - widened(aside)) && fits(moved_high + widened(aside));
    // 4: the greater one, if it is one
    in_range <= fits_3;
    if (gap_below > 0 && gap_below >= gap_above) gap <= gap_below[23:0];
    else gap <= gap_above > 0 ? gap_above[23:0] : '0;
  end
endmodule

// A square, two cycles later: registered behind the multiplier and once more.
module squarer #(
    parameter int BITS = 25
) (
    input logic clk,
    input logic [BITS-1:0] root,
    output logic [2*BITS-1:0] square
);
  logic [2*BITS-1:0] product;
  always_ff @(posedge clk) begin
    product <= (2 * BITS)'(root) * (2 * BITS)'(root);
    square <= product;
  end
endmodule

// The root of a square below 2^50, rounded down, two bits in each of 13 stages.
module root_pipeline (
    input logic clk,
    input logic [49:0] square,
    output logic [24:0] root,
    output logic has_rest
);
  localparam int STAGES = 13;
  logic [51:0] digits[0:STAGES];  // the highest ones are next
  logic [26:0] rest[0:STAGES];
  logic [25:0] found[0:STAGES];
  assign digits[0] = {2'b0, square};
  assign rest[0] = '0;
  assign found[0] = '0;

  for (genvar i = 0; i < STAGES; i++) begin : stage
    logic [27:0] rest_1, rest_2;
    logic [28:0] trial_1, trial_2;
    logic [26:0] next_1, next_2;
    logic [25:0] found_1, found_2;
    assign rest_1 = {rest[i][25:0], digits[i][51:50]};
    assign trial_1 = {1'b0, rest_1} - {1'b0, found[i], 2'b01};
    assign next_1 = trial_1[28] ? rest_1[26:0] : trial_1[26:0];
    assign found_1 = {found[i][24:0], ~trial_1[28]};
    assign rest_2 = {next_1[25:0], digits[i][49:48]};
    assign trial_2 = {1'b0, rest_2} - {1'b0, found_1, 2'b01};
    assign next_2 = trial_2[28] ? rest_2[26:0] : trial_2[26:0];
    assign found_2 = {found_1[24:0], ~trial_2[28]};
    always_ff @(posedge clk) begin
      digits[i+1] <= {digits[i][47:0], 4'd0};
      rest[i+1] <= next_2;
      found[i+1] <= found_2;
    end
  end
  assign root = found[STAGES][24:0];
  assign has_rest = rest[STAGES] != 0;
endmodule
