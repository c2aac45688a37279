#pragma once

#include "client/fly/flight.hpp"

namespace iwalk::client {

// How the wall is doing: connection, figures, and the map with each tile's load and health.
void drawStatus(const Flight& flight);
// What there is to say for a moment, or for as long as there is no server.
void drawNote(const Flight& flight);

}  // namespace iwalk::client
