/* Vectors of one or three signed integers; see `residual.h`. */
#include "residual.h"

void dm_code_vector(dm_coder *c, int64_t *value, int axes, const dm_known *known)
{
    const dm_candidates none = {0};
    int64_t magnitudes[DM_MAGNITUDES], signs[DM_SIGNS];
    const int64_t total = dm_total(known);
    int64_t spent = known->spent; /* and |v| of the coordinates before */
    int64_t along = 0; /* their scalar product with the sum over the neighbours */
    for (int axis = 0; axis < axes; axis++) {
        dm_set_magnitudes(magnitudes, known, axis, total, spent);
        dm_set_signs(signs, known, axis, along);
        value[axis] = dm_code_signed(c, value[axis], axis, magnitudes, DM_MAGNITUDES, signs,
                                     DM_SIGNS, &none);
        spent = dm_add(spent, dm_size(value[axis]));
        along = dm_add(along, dm_times(known->sum[axis], value[axis]));
    }
}
