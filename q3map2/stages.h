// GPL-2.0-or-later. The stages that the command line can name.
#pragma once
