#pragma once

#include "frontend/synthetic_matches.h"
