#pragma once

#include "app/view/model/view_model.h"
#include "app/view/ui/command.h"

namespace app::viewer {

/// Does what a command says. What only a window can do is noted in the model.
void perform(ViewModel& model, Command command, double now);

/// Puts the closest pair of the current block into the middle of the view.
void frame_witness(ViewModel& model);

/// Hands what the model wants to the worker. Whether it wanted anything.
bool send_requests(ViewModel& model, class SessionWorker& worker);

} // namespace app::viewer
