#pragma once

#include "app/viewer/device_worker.h"

namespace app::viewer {

struct ViewModel;

/// What the window knows of the coprocessor, and what a person wants of it.
struct DeviceModel {
    std::string file;     // of the device; empty: the usual one
    bool shown = false;   // its panel; while it is open, the program that is open is run
    uint64_t opening = 0; // of the program that was run, or is; 0: none
    uint64_t run = 0;     // its number
    bool is_running = false;
    bool is_fitting = false; // the answers are there, other devices are tried
    double share = 0.0;
    size_t blocks = 0; // that were asked so far
    std::shared_ptr<const DeviceStudy> study;
    std::optional<core::Error> failure;
};

/// Shows the panel, or hides it. What it has shown stays on the timeline; a run that has not
/// answered yet ends.
void show_device(ViewModel& model, bool shown);

/// Ends the run and forgets what came of it.
void switch_off_device(ViewModel& model);

/// Takes in what the worker has to tell; nothing of runs that nobody waits for any more.
void take_in(ViewModel& model, DeviceUpdate news);

/// Begins and ends runs, as the model says: what is run is the program that is open, as its files
/// and the edits of the set-up have it. Whether anything was begun or ended.
bool send_device_orders(ViewModel& model, DeviceWorker& worker,
                        const std::optional<CheckJob>& check);

/// To the next or previous block that the machine has to wait for or may not run, past the end to
/// the other one. Whether there is one that is known.
bool go_to_stop(ViewModel& model, bool forward);

} // namespace app::viewer
