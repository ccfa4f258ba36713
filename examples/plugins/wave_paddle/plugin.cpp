#include <weir/plugin.h>

#include "wave_paddle.h"

WEIR_PLUGIN("wave_paddle", "A wave maker.", registry) {
  registry.addNode<wave_paddle::WavePaddle>();
}
