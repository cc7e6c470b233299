// Chooses the part of a pair to divide, and computes the offsets of two samples of the path: a
// question in each cycle, its answer 6 cycles later.
module path_unit #(
    parameter int THREAD_BITS = 2
) (
    input logic clk,
    input logic flush,

    input logic                   in_valid,
    input logic [THREAD_BITS-1:0] in_thread,
    input device::path_question_t question,

    output logic                   out_valid,
    output logic [THREAD_BITS-1:0] out_thread,
    output device::path_answer_t   answer
);
  localparam int STAGES = 6;

  // A length, or -1 for what is not to be divided.
  typedef logic signed [26:0] length_t;

  logic [STAGES:1] valid;
  logic [THREAD_BITS-1:0] thread[1:STAGES];
  always_ff @(posedge clk) begin
    valid <= flush ? '0 : {valid[STAGES-1:1], in_valid};
    thread[1] <= in_thread;
    for (int i = 2; i <= STAGES; i++) thread[i] <= thread[i-1];
  end
  assign out_valid = valid[STAGES];
  assign out_thread = thread[STAGES];

  // Stages 1 to 4 of the offsets: way, product, half a step added, shifted and moved to the start.
  logic [3:0] log2_steps[1:3];
  device::sample_t sample_1_0, sample_1_1;
  always_ff @(posedge clk) begin
    log2_steps[1] <= question.path.log2_steps;
    log2_steps[2] <= log2_steps[1];
    log2_steps[3] <= log2_steps[2];
    sample_1_0 <= question.sample_0;
    sample_1_1 <= question.sample_1;
  end

  device::vector_t offset_4_0, offset_4_1;
  offset_axis x (.clk, .first(question.path.first.x), .last(question.path.last.x), .sample_0(sample_1_0), .sample_1(sample_1_1),
      .log2_steps_2(log2_steps[2]), .log2_steps_3(log2_steps[3]), .offset_0(offset_4_0.x), .offset_1(offset_4_1.x));
  offset_axis y (.clk, .first(question.path.first.y), .last(question.path.last.y), .sample_0(sample_1_0), .sample_1(sample_1_1),
      .log2_steps_2(log2_steps[2]), .log2_steps_3(log2_steps[3]), .offset_0(offset_4_0.y), .offset_1(offset_4_1.y));
  offset_axis z (.clk, .first(question.path.first.z), .last(question.path.last.z), .sample_0(sample_1_0), .sample_1(sample_1_1),
      .log2_steps_2(log2_steps[2]), .log2_steps_3(log2_steps[3]), .offset_0(offset_4_0.z), .offset_1(offset_4_1.z));

  // Stages 1 to 5 of the longest sides.
  function automatic length_t side(input device::coordinate_t low, input device::coordinate_t high);
    side = 27'(high) - 27'(low);
  endfunction
  function automatic length_t greater(input length_t a, input length_t b);
    greater = a > b ? a : b;
  endfunction

  length_t tool_x[1:2], tool_y[1:2], tool_z[1:3], tool_xy, tool_longest[4:5];
  length_t work_x[1:2], work_y[1:2], work_z[1:3], work_xy, work_longest[4:5];
  length_t diameter;
  logic [3:1] is_tool_leaf, is_work_leaf;
  always_ff @(posedge clk) begin
    is_tool_leaf <= {is_tool_leaf[2:1], question.tool_is_leaf};
    is_work_leaf <= {is_work_leaf[2:1], question.work_is_leaf};
    diameter <= 27'($signed({1'b0, question.tool_volume.radius, 1'b0}));

    tool_x[1] <= side(question.tool_volume.box.min.x, question.tool_volume.box.max.x);
    tool_y[1] <= side(question.tool_volume.box.min.y, question.tool_volume.box.max.y);
    tool_z[1] <= side(question.tool_volume.box.min.z, question.tool_volume.box.max.z);
    tool_x[2] <= tool_x[1] + diameter;
    tool_y[2] <= tool_y[1] + diameter;
    tool_z[2] <= tool_z[1];
    tool_xy <= greater(tool_x[2], tool_y[2]);
    tool_z[3] <= tool_z[2];
    tool_longest[4] <= is_tool_leaf[3] ? -27'sd1 : greater(tool_xy, tool_z[3]);
    tool_longest[5] <= tool_longest[4];

    work_x[1] <= side(question.work_box.min.x, question.work_box.max.x);
    work_y[1] <= side(question.work_box.min.y, question.work_box.max.y);
    work_z[1] <= side(question.work_box.min.z, question.work_box.max.z);
    work_x[2] <= work_x[1];
    work_y[2] <= work_y[1];
    work_z[2] <= work_z[1];
    work_xy <= greater(work_x[2], work_y[2]);
    work_z[3] <= greater(work_z[2], 27'sd0);
    work_longest[4] <= is_work_leaf[3] ? -27'sd1 : greater(work_xy, work_z[3]);
    work_longest[5] <= work_longest[4];
  end

  // Stage 5: how far apart the offsets are. Stage 6: the longest of all.
  function automatic length_t apart(input device::coordinate_t a, input device::coordinate_t b);
    length_t difference;
    difference = side(a, b);
    apart = difference < 0 ? -difference : difference;
  endfunction

  length_t way_x, way_y, way_z, way;
  device::vector_t offset_5_0, offset_5_1;
  assign way = greater(greater(way_x, way_y), way_z);
  always_ff @(posedge clk) begin
    way_x <= apart(offset_4_0.x, offset_4_1.x);
    way_y <= apart(offset_4_0.y, offset_4_1.y);
    way_z <= apart(offset_4_0.z, offset_4_1.z);
    offset_5_0 <= offset_4_0;
    offset_5_1 <= offset_4_1;

    answer.offset_0 <= offset_5_0;
    answer.offset_1 <= offset_5_1;
    if (tool_longest[5] >= 0 && tool_longest[5] >= work_longest[5] && tool_longest[5] >= way)
      answer.division <= device::TOOL;
    else if (work_longest[5] >= 0 && work_longest[5] >= way) answer.division <= device::WORK;
    else answer.division <= way > 0 ? device::WAY : device::NONE;
  end
endmodule

// One axis of the offsets of two samples. The samples belong to stage 1.
module offset_axis (
    input logic clk,
    input device::coordinate_t first,
    input device::coordinate_t last,
    input device::sample_t sample_0,
    input device::sample_t sample_1,
    input logic [3:0] log2_steps_2,
    input logic [3:0] log2_steps_3,
    output device::coordinate_t offset_0,
    output device::coordinate_t offset_1
);
  logic signed [24:0] way;
  logic signed [38:0] product_0, product_1, sum_0, sum_1;
  device::coordinate_t first_1, first_2, first_3;
  logic signed [38:0] half;
  assign half = $signed({26'd0, (13'd1 << log2_steps_2) >> 1});
  always_ff @(posedge clk) begin
    way <= 25'(last) - 25'(first);
    product_0 <= 39'($signed({1'b0, sample_0})) * 39'(way);
    product_1 <= 39'($signed({1'b0, sample_1})) * 39'(way);
    sum_0 <= product_0 + half;
    sum_1 <= product_1 + half;
    offset_0 <= 24'(sum_0 >>> log2_steps_3) + first_3;
    offset_1 <= 24'(sum_1 >>> log2_steps_3) + first_3;
    first_1 <= first;
    first_2 <= first_1;
    first_3 <= first_2;
  end
endmodule
