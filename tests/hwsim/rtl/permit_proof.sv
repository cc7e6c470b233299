// What the permit unit never does, whatever the host and the other units do; permit_proof.py proves it
// for a unit with few threads and a short FIFO. This text stands inside of the module. All inputs are
// free, so a thread that was started answers anything, at any time.

  logic has_begun = 1'b0;
  always_ff @(posedge clk) has_begun <= 1'b1;

  // It begins with a reset. The ring unit gives no entry if there is no room, no fault without a
  // reason, and no measurement or model that is the last of its segment.
  always_comb begin
    if (!has_begun) assume (reset);
    if (fifo_used == 13'(FIFO_DEPTH)) assume (!entry_valid);
    if (fault_valid) assume (fault != device::NO_STOP);
    assume (entry.kind != 2'd3);
    if (entry.last) assume (entry.kind == device::PERMIT);
  end

  // Of all numbers of segments one is watched: how many entries ask for its permit, and how many were
  // answered with yes. Of all searches some are marked: the mark of an entry, and that of the thread
  // which answers it.
  (* anyconst *) logic [31:0] watched;
  (* anyseq *) logic mark;
  logic [3:0] asked, granted;
  logic [QUEUE_DEPTH-1:0] queue_marks;
  logic [ALL_THREADS-1:0] thread_marks;
  logic says_yes;
  assign says_yes = retires && first.kind == device::PERMIT && first.is_searched
      && answer.stop == device::NO_STOP && !answer.found
      && queue_marks[queue_first[QUEUE_BITS-1:0]] == thread_marks[number_of(first.element, first.thread)];
  always_ff @(posedge clk) begin
    if (is_dispatched) queue_marks[queue_end[QUEUE_BITS-1:0]] <= mark;
    if (is_dispatched && is_search) thread_marks[number_of(chosen_element, chosen_thread)] <= mark;
    if (is_taken && !is_out_of_turn && entry.kind == device::PERMIT && entry.sequence_number == watched)
      asked <= asked + 4'd1;
    if (says_yes && first.sequence_number == watched) granted <= granted + 4'd1;
    if (reset || reason != device::NO_STOP) begin
      asked <= '0;
      granted <= '0;
    end
  end

  // What is true of its memories at any time: numbers of segments go up without gaps, from the first
  // that is not permitted to the next that is taken; every search has a thread of its own.
  logic is_in_order, has_own_threads, has_own_marks;
  logic [3:0] left;
  logic [31:0] expected;
  logic [ALL_THREADS-1:0] used;
  logic [QUEUE_BITS:0] place;
  dispatched_t d;
  device::entry_t e;
  always_comb begin
    d = '0;
    e = '0;
    place = '0;
    is_in_order = 1'b1;
    has_own_threads = 1'b1;
    has_own_marks = 1'b1;
    left = '0;
    used = '0;
    if (release_valid) used[number_of(release_element, release_thread)] = 1'b1;
    expected = permit_sequence + 32'd1;
    for (int k = 0; k < QUEUE_DEPTH; k++)
      if (13'(k) < dispatched) begin
        place = {1'b0, queue_first[QUEUE_BITS-1:0]} + (QUEUE_BITS+1)'(k);
        if (place >= (QUEUE_BITS+1)'(QUEUE_DEPTH)) place = place - (QUEUE_BITS+1)'(QUEUE_DEPTH);
        d = queue[place[QUEUE_BITS-1:0]];
        if (d.sequence_number != expected || d.sequence_number == 0) is_in_order = 1'b0;
        if (d.last && d.kind != device::PERMIT) is_in_order = 1'b0;
        if (d.kind == 2'd3) is_in_order = 1'b0;
        // An entry that asks is searched, or has a fault.
        if (d.kind != device::MODEL && !d.is_searched && d.fault == device::NO_STOP) is_in_order = 1'b0;
        if (d.kind == device::PERMIT && d.sequence_number == watched) left = left + 4'd1;
        if (d.last) expected = expected + 32'd1;
        if (d.is_searched) begin
          if (d.element >= 6'(ELEMENTS) || d.thread >= 4'(THREADS)) has_own_threads = 1'b0;
          if (used[number_of(d.element, d.thread)]) has_own_threads = 1'b0;
          if (!occupied[number_of(d.element, d.thread)]) has_own_threads = 1'b0;
          used[number_of(d.element, d.thread)] = 1'b1;
          if (queue_marks[place[QUEUE_BITS-1:0]] != thread_marks[number_of(d.element, d.thread)])
            has_own_marks = 1'b0;
        end
      end
    for (int k = 0; k < FIFO_DEPTH; k++)
      if (13'(k) < fifo_used) begin
        place = (QUEUE_BITS+1)'(fifo_first[FIFO_BITS-1:0]) + (QUEUE_BITS+1)'(k);
        if (place >= (QUEUE_BITS+1)'(FIFO_DEPTH)) place = place - (QUEUE_BITS+1)'(FIFO_DEPTH);
        e = fifo[place[FIFO_BITS-1:0]];
        if (e.sequence_number != expected || e.sequence_number == 0) is_in_order = 1'b0;
        if (e.last && e.kind != device::PERMIT) is_in_order = 1'b0;
        if (e.kind == 2'd3) is_in_order = 1'b0;
        if (e.kind == device::PERMIT && e.sequence_number == watched) left = left + 4'd1;
        if (e.last) expected = expected + 32'd1;
      end
    if (next_sequence != expected) is_in_order = 1'b0;
  end

  logic [31:0] permitted;
  logic [3:0] stopped;
  logic was_reset, was_cleared, was_enabled;
  always_ff @(posedge clk) begin
    permitted <= permit_sequence;
    stopped <= stop;
    was_reset <= reset;
    was_cleared <= clear;
    was_enabled <= enable;
  end
  always_comb if (has_begun) begin
    assert (dispatched <= 13'(QUEUE_DEPTH) && fifo_used <= 13'(FIFO_DEPTH));
    assert (queue_first < 13'(QUEUE_DEPTH) && fifo_first < 12'(FIFO_DEPTH) && next_element < 6'(ELEMENTS));
    assert (queue_end == (queue_first + dispatched >= 13'(QUEUE_DEPTH)
        ? queue_first + dispatched - 13'(QUEUE_DEPTH) : queue_first + dispatched));
    assert (fifo_end == 12'({1'b0, fifo_first} + fifo_used >= 13'(FIFO_DEPTH)
        ? {1'b0, fifo_first} + fifo_used - 13'(FIFO_DEPTH) : {1'b0, fifo_first} + fifo_used));
    if (release_valid) begin
      assert (release_element < 6'(ELEMENTS) && release_thread < 4'(THREADS));
      assert (occupied[number_of(release_element, release_thread)]);
    end
    if (stop != device::NO_STOP) assert (dispatched == 0 && fifo_used == 0 && !release_valid && !start);
    else assert (is_in_order);
    assert (has_own_threads);
    // An answer is that of the search which was started for the entry.
    assert (has_own_marks);
    // A permit is given when all who asked for it have an answer, and all answers were yes.
    if (stop == device::NO_STOP) assert (asked - granted == left);
    if (permits && !reset && first.sequence_number == watched)
      assert (says_yes && asked == granted + 4'd1);
    // Permits only go up, one at a time, and not beyond the last number.
    if (!was_reset) begin
      assert (permit_sequence == permitted || permit_sequence == permitted + 32'd1);
      assert (permit_sequence >= permitted);
    end
    // A device that is stopped or disabled permits and starts nothing; a stop lasts until it is cleared.
    if (!was_reset && stopped != device::NO_STOP && !was_cleared)
      assert (permit_sequence == permitted && !start && stop == stopped);
    if (!was_reset && !was_enabled) assert (permit_sequence == permitted && !start);
  end
