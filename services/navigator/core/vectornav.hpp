// VectorNav's sentences, field by field.
#pragma once

#include "services/navigator/core/field_reader.hpp"
#include "services/navigator/core/nmea.hpp"

namespace lookout::navigator {

VnIns ReadVnIns(FieldReader& fields);
VnYmr ReadVnYmr(FieldReader& fields);
VnImu ReadVnImu(FieldReader& fields);

}  // namespace lookout::navigator
