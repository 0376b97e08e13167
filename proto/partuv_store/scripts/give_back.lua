-- ARGV: job id, attempt, losses allowed (0: not a loss), error as JSON. A worker can't go on.
-- Returns the job's status afterwards, or lost where it was not this attempt's any more.
local id, attempt = ARGV[1], ARGV[2]
if not owns(id, attempt) then
  drop_parts(id, attempt)
  return 'lost'
end
local max_losses = tonumber(ARGV[3])
if max_losses > 0 then
  lose(id, max_losses, ARGV[4])
else
  drop_parts(id, attempt)
  if redis.call('HGET', key('job', id), 'cancel_requested') then
    conclude(id, 'canceled', '', {})
  else
    requeue(id)
  end
end
return redis.call('HGET', key('job', id), 'status')
