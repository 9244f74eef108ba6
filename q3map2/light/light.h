// GPL-2.0-or-later. The light stage.
#pragma once
