#include "element.hpp"
