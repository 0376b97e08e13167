-- ARGV: blob, chunk number, bytes, budget (0: none), seconds to live.
-- Returns 1, or 0 where the budget is spent.
local blob, index, chunk = ARGV[1], ARGV[2], ARGV[3]
local budget = tonumber(ARGV[4])
if budget > 0 and stored_bytes() + #chunk > budget then return 0 end
-- A chunk written twice (a retried command) is weighed once.
if redis.call('HSET', key('blob', blob), index, chunk) == 1 then weigh(blob, #chunk) end
redis.call('EXPIRE', key('blob', blob), ARGV[5])
return 1
