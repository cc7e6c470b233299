#!/usr/bin/env python3
"""Plants faults in a copy of the circuit, one at a time, and expects the lockstep tests, or the proof about permits, to
fail with each.

Usage: mutants.py SOURCE_DIRECTORY [FAULT...]      (numbers, from 1)
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

# (file, text, replacement)
FAULTS = [
    ("path_unit.sv", "(13'd1 << log2_steps_2) >> 1", "13'd0 & {9'd0, log2_steps_2}"),
    ("path_unit.sv", "tool_longest[5] >= work_longest[5]", "tool_longest[5] > work_longest[5]"),
    ("path_unit.sv", "tool_y[1] + diameter", "tool_y[1]"),
    ("path_unit.sv", "way > 0 ? device::WAY", "way > 1 ? device::WAY"),
    ("gap_unit.sv", "value <= 27'(device::GREATEST)", "value < 27'(device::GREATEST)"),
    ("gap_unit.sv", "fits(moved_high + widened(aside))", "fits(moved_high)"),
    ("gap_unit.sv", "{26'd0, has_rest}", "{26'd0, has_rest & root[0]}"),
    ("gap_unit.sv", "less_radius < 0 ? '0", "less_radius < -27'sd1 ? '0"),
    ("gap_unit.sv", "{has_radius[STAGES-2:ROOT+1], radius[ROOT] != 0}", "{has_radius[STAGES-2:ROOT+1], 1'b1}"),
    ("gap_unit.sv", "valid <= flush ? '0 : ", "valid <= "),
    ("check_unit.sv", "{in_line[95:0], in_address}", "{in_line[95:0], in_address & 32'h7FFF_FFFF}"),
    ("check_unit.sv", "lines[3][511:480] ==", "lines[3][511:481] =="),
    ("line_cache.sv", "if (is_snooped && snooped_tag == forgotten_tag)", "if (is_snooped && snooped_tag > forgotten_tag)"),
    ("line_cache.sv", "if (forget && any_fill)", "if (forget && any_fill && fill)"),
    ("line_cache.sv", "is_valid && read_tag == looked_tag", "is_valid"),
    ("search_thread.sv", "is_stale <= 1'b1", "is_stale <= 1'b0"),
    ("search_thread.sv", "records_answer && {1'b0, gap_answer.squared} <", "records_answer && {1'b0, gap_answer.squared} <="),
    ("search_thread.sv", "squared_1 < squared_0", "squared_1 <= squared_0"),
    ("search_thread.sv", "{1'b0, popped.squared} <", "{1'b0, popped.squared} <="),
    ("search_thread.sv", "cycle - started > search_limit", "cycle - started >= search_limit"),
    ("search_thread.sv", "of_work ? work_epoch : tool_epoch", "of_work ? tool_epoch : tool_epoch"),
    ("search_thread.sv", "line_address < memory_lines", "line_address <= memory_lines"),
    ("search_thread.sv", "half_1.first <= middle + 13'd1", "half_1.first <= middle"),
    ("search_thread.sv", "in_gap_unit_next == 0) phase", "in_gap_unit == 0) phase"),
    ("search_element.sv", "first == 4'(THREADS - 1) ? '0 : first + 4'd1", "first == 4'(THREADS - 1) ? '0 : first"),
    ("search_element.sv", "!request || granted ?", "!request ?"),
    ("search_element.sv", "response_is_intact && !is_stale[i]", "response_is_intact"),
    ("search_element.sv", "looks && !flush && !reset", "looks && !reset"),
    ("search_element.sv", "push_place |= stack_sizes[7*i+:6]", "push_place |= {2'b0, stack_sizes[7*i+:4]}"),
    ("permit_unit.sv", "retires = enable && dispatched != 0", "retires = dispatched != 0"),
    ("permit_unit.sv", "retire_stop == device::NO_STOP && enable", "retire_stop == device::NO_STOP"),
    ("permit_unit.sv", "lines_written < waiting.lines", "lines_written + 64'd1 < waiting.lines"),
    ("permit_unit.sv", "work_model[57:26] != waiting.work_epoch", "work_model[57:26] > waiting.work_epoch"),
    ("permit_unit.sv", " || next_sequence_now == 0)", ")"),
    ("permit_unit.sv", "entry_valid && !flush", "entry_valid"),
    ("permit_unit.sv", "first.kind == device::PERMIT && is_searched_answer", "first.last && is_searched_answer"),
    ("permit_unit.sv", "reason_sequence = permitted_now + 32'd1", "reason_sequence = permit_sequence + 32'd1"),
    ("permit_unit.sv", "{1'b0, threshold} + 24'd3", "{1'b0, threshold} + 24'd2"),
    ("permit_unit.sv", "has_model_now = is_cleared ? '0 : has_model", "has_model_now = has_model"),
    ("permit_unit.sv", "$signed(slack) < $signed(least_slack)", "slack < least_slack"),
    ("permit_unit.sv", "number_of(release_element, release_thread)] = 1'b0", "number_of(release_element, 4'd0)] = 1'b0"),
    ("search_element.sv", "64'(count_of(is_done))", "64'(is_done != 0)"),
    ("ring_unit.sv", "ahead < QUEUE_DEPTH", "ahead <= QUEUE_DEPTH"),
    ("ring_unit.sv", "stale <= way_level_next", "stale <= way_level"),
    ("ring_unit.sv", "32'(on_the_way) < 32'(memory_room)", "32'(copying) < 32'(memory_room)"),
    ("ring_unit.sv", "next_is_missing) line_fault = device::BAD_ADDRESS", "next_is_missing) line_fault = device::BAD_DESCRIPTOR"),
    ("ring_unit.sv", "common.last && pairs == 8'd1", "common.last"),
    ("ring_unit.sv", " || !are_coordinates)", ")"),
    ("ring_unit.sv", "tail - head_now > (32'd1 << log2_size)", "tail - head_now > (32'd2 << log2_size)"),
    ("ring_unit.sv", "is_first_line ? 3'd2 : 3'd5", "is_first_line ? 3'd2 : 3'd4"),
    ("ring_unit.sv", "lines_asked <= lines_asked + 64'd1", "lines_asked <= lines_asked"),
    ("ring_unit.sv", "has_copied && copied_is_missing && !copied_is_stale", "has_copied && copied_is_missing"),
    ("memory_unit.sv", "stale <= asked_next + under_way_next", "stale <= asked + under_way"),
    ("memory_unit.sv", "WRITE_BITS'(WRITE_QUEUE_DEPTH) && !write_was_last", "WRITE_BITS'(WRITE_QUEUE_DEPTH)"),
    ("memory_unit.sv", "arrives && stale == 0 && !flush", "arrives && !flush"),
    ("memory_unit.sv", "!is_due || has_read || is_written || arrives", "!is_due || has_read || arrives"),
    ("register_file.sv", "is_enabled_now || (clear && stop != device::NO_STOP)", "is_enabled_now"),
    ("register_file.sv", "irq_pending & ~bus_data", "old_irq_pending & ~bus_data"),
    ("register_file.sv", "bus_write && !was_enabled", "bus_write"),
    ("register_file.sv", "if (bus_read) high_word <= high", "high_word <= high"),
    ("coprocessor.sv", "'0 : request_element + 6'd1", "'0 : request_element"),
    ("coprocessor.sv", "stop != device::NO_STOP && !clear", "1'b0"),
    ("coprocessor.sv", "13'(FIFO_DEPTH) - fifo_used > 13'(entry_valid)", "13'(FIFO_DEPTH) != fifo_used"),
]
TESTS = ("hwsim_rtl_unit_test", "hwsim_rtl_element_test", "hwsim_rtl_device_test")


def run(command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", **options)


def expect_success(result):
    if result.returncode != 0:
        sys.exit(result.stdout[-4000:])


def plant(path, text, replacement):
    source = path.read_text(encoding="utf-8")
    if text not in source:
        sys.exit(f"{path.name} does not contain: {text}")
    path.write_text(source.replace(text, replacement, 1), encoding="utf-8")


def is_noticed(source, circuit, build, file=None):
    """Which test fails; what does not compile is no fault to notice."""
    expect_success(run(["ninja", "-C", build, *TESTS]))
    for test in TESTS:
        result = run([f"{build}/tests/hwsim/rtl/{test}", "--gtest_brief=1", "--gtest_fail_fast"])
        failed = re.findall(r"\[  FAILED  \] (\S+) ", result.stdout)
        if result.returncode != 0:
            return failed[0] if failed else f"{test} ends with {result.returncode}"
    if file == "permit_unit.sv":
        proof = pathlib.Path(source, "tests/hwsim/rtl/permit_proof.py")
        if run([sys.executable, "-B", proof, source, circuit]).returncode != 0:
            return proof.name
    return None


def main(source, *chosen):
    numbers = [int(n) for n in chosen] or range(1, len(FAULTS) + 1)
    unnoticed = []
    with tempfile.TemporaryDirectory(prefix="feeler-mutants-") as folder:
        original, circuit, build = pathlib.Path(source, "hwsim/rtl"), pathlib.Path(folder, "rtl"), folder + "/build"
        shutil.copytree(original, circuit)
        expect_success(run(["cmake", "-S", source, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                            "-DFEELER_UNITY=ON", "-DFEELER_TESTS=ON", f"-DFEELER_CIRCUIT={circuit}"]))
        if is_noticed(source, circuit, build):
            sys.exit("the tests fail without a fault")
        for number in numbers:
            name, text, replacement = FAULTS[number - 1]
            plant(circuit / name, text, replacement)
            test = is_noticed(source, circuit, build, name)
            print(f"{number:2} {name}: {replacement}: {test or 'NOT NOTICED'}", flush=True)
            if not test:
                unnoticed.append(number)
            shutil.copy(original / name, circuit / name)
    if unnoticed:
        sys.exit(f"not noticed: {unnoticed}")


if __name__ == "__main__":
    main(*sys.argv[1:])
