#pragma once

#include <map>
#include <string>

#include "client/fly/flight.hpp"

namespace iwalk::client {

// Every setting of the servers that can change while they run, to be changed.
class SettingsPanel {
  public:
    void draw(Flight& flight);

  private:
    void drawRow(Flight& flight, const char* name, const std::string& form, const std::string& value);

    std::map<std::string, std::string> typed_;  // what is being written, by setting
};

}  // namespace iwalk::client
