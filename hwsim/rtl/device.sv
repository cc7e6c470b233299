// Types of the device, as in hwsim/README.md: a field that is named first has the highest bits.
package device;

  typedef logic signed [23:0] coordinate_t;
  typedef logic [19:0] extent_t;
  typedef logic [12:0] sample_t;
  typedef logic [25:0] line_address_t;
  typedef logic [31:0] reference_t;
  localparam int NAME_BITS = 28;
  typedef logic [NAME_BITS-1:0] record_name_t;
  typedef logic [49:0] squared_t;

  typedef struct packed {coordinate_t z, y, x;} vector_t;
  typedef struct packed {vector_t max, min;} box_t;
  typedef struct packed {extent_t radius; box_t box;} volume_t;
  typedef struct packed {extent_t half, run; vector_t base;} record_t;

  // The path of a segment: 2^log2_steps + 1 samples.
  typedef struct packed {vector_t last, first; logic [3:0] log2_steps;} path_t;

  // A part of the tool over some samples, and a part of the work.
  typedef struct packed {
    squared_t squared;  // lower bound of their distance
    sample_t last, first;
    box_t work_box;
    volume_t tool_volume;
    reference_t work, tool;
  } pair_t;
  localparam int PAIR_BITS = 448;

  typedef struct packed {
    logic [50:0] limit;
    logic [31:0] work_epoch, tool_epoch;
    line_address_t work_header, tool_header;
    path_t path;
  } query_t;

  // An entry of the FIFO: a path and a pair of models, or a model for a slot.
  typedef enum logic [1:0] {PERMIT, MEASURE, MODEL} kind_t;
  typedef struct packed {
    logic [63:0] lines;  // that were copied before it
    logic [63:0] asked;  // cycle in which its descriptor was asked for
    logic [31:0] deadline;
    logic is_timed, last;
    logic [25:0] model_header;
    logic [31:0] work_epoch;
    logic [22:0] threshold;
    path_t path;
    logic [4:0] work_slot, tool_slot;
    kind_t kind;
    logic [31:0] sequence_number;
  } entry_t;
  localparam int ENTRY_BITS = 435;

  // What a pair is divided into: parts of the tool, of the work, of the path; or nothing.
  typedef enum logic [1:0] {TOOL, WORK, WAY, NONE} division_t;

  typedef enum logic [4:0] {
    IDLE, DIVIDE, DIVIDING, OPEN, MIDDLE, HALVING, TEST, TESTED, POP, POPPED,
    TAKE_TOOL, TAKE_WORK, COMPARE, DRAIN, LOOK, ASK, WAIT_LINE, DONE
  } phase_t;

  typedef enum logic [3:0] {
    NO_STOP, VIOLATION, OUT_OF_RANGE, SEQUENCE, FIFO_OVERRUN, MODEL_MISSING, MODEL_CHANGED,
    BAD_CHECK, BAD_ADDRESS, STACK_OVERFLOW, TOO_LONG, MEMORY_STALLED, HOST_SILENT, BAD_DESCRIPTOR
  } stop_t;

  typedef struct packed {
    path_t path;
    sample_t sample_1, sample_0;
    logic tool_is_leaf, work_is_leaf;
    volume_t tool_volume;
    box_t work_box;
  } path_question_t;
  localparam int PATH_QUESTION_BITS = 484;

  typedef struct packed {
    division_t division;
    vector_t offset_1, offset_0;
  } path_answer_t;

  typedef struct packed {
    logic of_records;  // otherwise of a half
    logic half;        // which one
    vector_t offset_1, offset_0;
    volume_t tool_volume;
    box_t work_box;
    record_t tool_record, work_record;
    record_name_t tool_name, work_name;
  } gap_question_t;
  localparam int GAP_QUESTION_BITS = 734;

  typedef struct packed {
    logic of_records, half, in_range;
    record_name_t tool_name, work_name;
    squared_t squared;
  } gap_answer_t;

  // What a search finds; `squared` is its limit as long as nothing is found.
  typedef struct packed {
    stop_t stop;
    logic [26:0] at_line;
    logic found;
    logic [50:0] squared;
    record_name_t tool_record, work_record;
    sample_t sample;
    logic [31:0] nodes, splits, box_tests, pair_tests;
    logic [6:0] deepest;
  } answer_t;
  localparam int ANSWER_BITS = 287;

  // Counters since reset: of an element, and of all searches.
  typedef struct packed {
    logic [63:0] busy, node_hits, node_misses, record_hits, record_misses, wait_memory, wait_port, wait_retire;
  } element_counts_t;
  localparam int ELEMENT_COUNTS_BITS = 512;

  typedef struct packed {
    logic [63:0] queries, nodes, splits, box_tests, pair_tests;
    logic [6:0] deepest;
  } search_totals_t;

  // What is read of a line in a search: all but the check word.
  localparam int LINE_BITS = 480;
  typedef logic [LINE_BITS-1:0] line_t;

  typedef struct packed {
    logic [31:0] epoch, zero;
    logic [11:0] unused_1;
    extent_t radius_1;
    logic [11:0] unused_0;
    extent_t radius_0;
    reference_t child_1, child_0;
    box_t box_1, box_0;
  } node_line_t;

  localparam int RECORD_BITS = 112;
  typedef struct packed {logic [31:0] epoch; logic [4*RECORD_BITS-1:0] records;} leaf_line_t;

  // Bit 31: a leaf; bits 30 to 26: its number of records less 1; bits 25 to 0: the line.
  localparam reference_t NO_REFERENCE = 32'h7FFF_FFFF;

  localparam coordinate_t LEAST = 24'sh800000;
  localparam coordinate_t GREATEST = 24'sh7FFFFF;
  localparam box_t EVERYWHERE = {{3{24'h7FFFFF}}, {3{24'h800000}}};

endpackage
